// What `coppice bench accuracy` measured, in memory: the JSON, the table and the page are made from it.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include "tools/accuracy/metrics.h"
#include "tools/coppice/figure.h"

namespace coppice {

struct AccuracyView {
    std::string name;            // "1: inside the stand"; unique
    std::string reference_file;  // picture beside the page
    double plant_coverage;       // share of the picture that shows plants
};

// One method at one setting of its quality, in one view.
struct AccuracySample {
    uint32_t method, view;  // into AccuracyRecord
    double quality;         // as the method names it
    double frame_ms;        // median
    uint64_t triangles, lines, points;
    uint64_t geometry_bytes,
        list_bytes;                 // vertices and owners the method keeps; instances and entries of a frame
    FrameErrors errors;             // against the reference with shadows
    FrameErrors unshadowed_errors;  // against the reference lit as frames are: the level of detail's own
    std::string picture_file, flip_file;  // beside the page; empty: not kept
};

struct AccuracyMethodRecord {
    std::string name;          // "hybrid, measured"
    std::string what;          // one sentence
    std::string quality_name;  // "d' px"; "" where there is nothing to sweep
    bool is_default = false;   // what the program does when nothing is chosen
    double default_quality = 0.0;
    // Over all views of a flight at the method's default quality; empty where not measured.
    std::optional<double> pop_energy, shimmer;
};

struct AccuracyRecord {
    std::string command;  // what to type to get this again
    std::string scene_name;
    uint32_t width, height, reference_samples;
    std::string device, driver, machine, date;
    uint64_t plants, scene_triangles;
    double duration_s;  // of the whole bench, references apart
    std::vector<AccuracyView> views;
    std::vector<AccuracyMethodRecord>
        methods;  // methods[full_method] is every triangle at one sample a pixel
    uint32_t full_method = 0;
    std::vector<AccuracySample> samples;
    // A resting view: errors after n frames, n = 1, 2, 4 ...
    struct Resting {
        uint32_t view, frames;
        double total_ms;
        FrameErrors errors, unshadowed_errors;
    };
    std::vector<Resting> resting;
    std::vector<Figure> figures;  // what the bench is to reach
};

}  // namespace coppice
