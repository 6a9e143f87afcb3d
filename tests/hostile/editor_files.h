// The scene that hostile journals, scripts and plants belong to, and journals as bytes.
#pragma once
#include <string>
#include "editor/document/journal.h"

namespace coppice::hostile {

inline constexpr const char* k_edited_scene = R"({
  "note": {"kept": [1,2,   3]},
  "plants": {"oak": {"source": "oak.json", "variations": 3, "height_m": 14}, "fern": {"source": "fern.glb"}},
  "regions": {"pond": {"circle": {"center": [20, 0], "radius_m": 8}}},
  "terrain": {"procedural": {"size_m": 256, "cell_m": 16, "seed": 3, "amplitude_m": 10, "wavelength_m": 90}},
  "placements": [{"packed": "planted.plants"},
    {"scatter": {"plant": "oak", "count": 9, "region": {"rectangle": {"center": [-50, -50], "size_m": [40, 40]}}}}]
})";

// What it is called in journals that have no folder yet.
inline constexpr const char* k_journalled_scene = "journalled.eco.json";

// As Journal writes them, whole.
std::string write_journal(const JournalContent& content);

}  // namespace coppice::hostile
