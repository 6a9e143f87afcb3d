// A playthrough as figures and tables for machines: frames.csv, summary.json.
#pragma once
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include "tools/coppice/figure.h"
#include "tools/coppice/play_record.h"

namespace coppice {

// The figures people ask for first; at least one frame is required.
std::vector<Figure> play_figures(const PlayRecord& record);

// One line a frame: times in ms by pass, counts by kind. Where PresentMon has a name for a time, it is that:
// CPUStartTime, FrameTime, CPUBusy, CPUWait, GPUBusy.
std::string frames_csv(const PlayRecord& record);

nlohmann::json play_summary(const PlayRecord& record);

const char* name_of(ProjectionMode mode);

}  // namespace coppice
