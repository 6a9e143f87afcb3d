// A playthrough as one HTML page that needs nothing beside it: figures, plots and pictures for people.
#pragma once
#include <string>
#include "tools/coppice/play_record.h"

namespace coppice {

// At least one frame is required. Pictures without PNG are linked, not embedded.
std::string play_page(const PlayRecord& record);

}  // namespace coppice
