// One frame at a time, when another program asks for it: how `coppice compare` draws the same frames with two programs in
// turn, so that both see the same machine.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include "plugins/vegetation/report/report.h"
#include "runtime/core/result.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_options.h"

namespace coppice {

// Writes {"frames": N} when it is ready, then answers each line "FRAME SLOWER" of standard input with the line
// {"ms": ..., "counts": {...}}: it drew that frame of the path, and waited busily for SLOWER times as long on top, which is
// how a comparison is tried out. Ends with the input. Errors: usage (a line it does not understand), and the frames'.
Status play_in_lockstep(PlayHost& host, const PlayOptions& options);

// What a frame is made of, by name: what may not grow, whatever the time says.
std::map<std::string, double> frame_counts(const FrameReport& report, uint64_t allocations);

}  // namespace coppice
