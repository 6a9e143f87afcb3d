// A bench of accuracy that never was, small enough to know every answer.
#pragma once
#include <cctype>
#include <cstdint>
#include <string>
#include "tools/accuracy/accuracy_record.h"

namespace coppice {

inline AccuracySample make_sample(uint32_t method, uint32_t view, double quality, double frame_ms,
                                  double error) {
    AccuracySample sample{method, view, quality, frame_ms, 1, 2, 3, 4, 5};
    sample.errors = {error, 20.0, error, error, -error, error, error};
    sample.unshadowed_errors = {error / 2, 26.0, error / 2, error / 2, -error / 2, error / 2, error / 2};
    sample.picture_file = "picture.png";
    sample.flip_file = "flip.png";
    return sample;
}

// Two views. Method 0: full geometry, 1000 ms, 0.10. Method 1: the default, 100 ms at 0.5 px with 0.08, 20 ms
// at 1 px with 0.12; the finest was measured in one view only. Method 2: 18 ms, 0.12.
inline AccuracyRecord make_record() {
    AccuracyRecord record{};
    record.command = "coppice bench accuracy";
    record.scene_name = "made";
    record.width = 64;
    record.height = 48;
    record.reference_samples = 64;
    record.device = "none";
    record.views = {{"1: \"near\", <inside>", "reference 0.png", 0.9},
                    {"2: far & above", "reference 1.png", 0.2}};
    record.methods = {{"every triangle", "All of them.", ""},
                      {"hybrid, <measured> & blended", "The default.", "d' px", true, 1.0, 1e-4, 0.01},
                      {"points", "Points.", "d' px", false, 1.0, 2e-4, 0.02}};
    for (uint32_t view = 0; view < 2; ++view) {
        const double times = view == 0 ? 0.5 : 1.5;  // the mean is what the list above says
        record.samples.push_back(make_sample(0, view, 0, 1000 * times, 0.10 * times));
        if (view == 0) record.samples.push_back(make_sample(1, view, 0.1, 1, 0.001));
        record.samples.push_back(make_sample(1, view, 0.5, 100 * times, 0.08 * times));
        record.samples.push_back(make_sample(1, view, 1, 20 * times, 0.12 * times));
        record.samples.push_back(make_sample(2, view, 1, 18 * times, 0.12 * times));
    }
    for (uint32_t frames = 1; frames <= 4; frames *= 2)
        record.resting.push_back({1, frames, 30.0 * frames, {.flip = 0.2 / frames}, {.flip = 0.1 / frames}});
    record.figures = {
        {"reached", 60, "times", 50.0}, {"missed", 1.2, "times", 1.0, Reach::at_most}, {"told", 3, "s", {}}};
    return record;
}

// Whether a text has a word of letters and digits of its own, in whatever case.
inline bool has_word(const std::string& text, const std::string& lower_word) {
    std::string word;
    for (char c : text + " ") {
        if (std::isalnum(static_cast<unsigned char>(c))) {
            word += char(std::tolower(static_cast<unsigned char>(c)));
        } else {
            if (word == lower_word) return true;
            word.clear();
        }
    }
    return false;
}

}  // namespace coppice
