// Stems become closed tubes with bark colours, in parts of about one thickness: trunk, branches, twigs. Each
// part has its skeleton, so that each can turn into lines at its own distance.
#pragma once
#include <vector>
#include "plugins/modeller/part_builder.h"
#include "plugins/modeller/stems.h"

namespace coppice::modeller {

// Empty parts are left out. Smooth normals; the trunk's foot reaches a little under the ground and is capped.
std::vector<PartDescription> mesh_stems(const TreeParameters& parameters, const StemTree& tree,
                                        Random random);

}  // namespace coppice::modeller
