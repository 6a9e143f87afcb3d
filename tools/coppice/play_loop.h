// Flies a scene's path at a fixed step and measures every frame.
#pragma once
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_options.h"
#include "tools/coppice/play_record.h"

namespace coppice {

// Frames of the whole path at a fixed step, or as many as the options say; at least one.
uint32_t count_frames(const PlayOptions& options, const Scene& scene);

// The path is flown options.repeats times. Every frame is waited for, so that nothing overlaps and the times are of one frame alone. Pictures are read
// after the frame's time was taken, and written into options.out where it is given. With options.compare_full
// some frames are drawn once more with every triangle, right after. Pictures and those only of the first repeat.
Result<PlayRecord> play_headless(PlayHost& host, const PlayOptions& options);

// Writes frames.csv, summary.json, trace.json, junit.xml and index.html into the folder.
Status write_report(const PlayRecord& record, const std::string& out);

}  // namespace coppice
