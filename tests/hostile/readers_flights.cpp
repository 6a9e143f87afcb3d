// What `coppice compare` reads of two flights: a report, and a table of frames.
#include <filesystem>
#include "tests/hostile/reader.h"
#include "tests/hostile/require.h"
#include "tests/hostile/scratch.h"
#include "tests/hostile/seeds.h"
#include "tools/coppice/compare_folders.h"

namespace coppice::hostile {
namespace {

bool compare(std::span<const std::byte> summary, std::span<const std::byte> frames) {
    const Bytes right_summary = flight_summary_seeds().front(), right_frames = flight_frames_seeds().front();
    for (const char* folder : {"base", "new"})
        std::filesystem::create_directories(Scratch::folder() + "/" + folder);
    const Scratch files[] = {{"base/summary.json", right_summary},
                             {"base/frames.csv", right_frames},
                             {"new/summary.json", summary},
                             {"new/frames.csv", frames}};
    const std::string base = Scratch::folder() + "/base", changed = Scratch::folder() + "/new";
    bool right = true;
    for (const std::string& other : {base, changed}) {
        const auto comparison = compare_folders(other, changed, 0.03);
        right = accepted(comparison) && right;
        if (!comparison) continue;
        require(!describe(*comparison).empty(), "a comparison can be told");
        to_json(*comparison).dump();
        if (const Status verdict = status_of(*comparison); !verdict) require_clear(verdict.error());
    }
    return right;
}

}  // namespace

bool read_flight_summary(std::span<const std::byte> bytes) {
    return compare(bytes, flight_frames_seeds().front());
}
bool read_flight_frames(std::span<const std::byte> bytes) {
    return compare(flight_summary_seeds().front(), bytes);
}

}  // namespace coppice::hostile
