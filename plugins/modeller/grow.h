// From a species to a plant: one function a form. Pure: same species and variation, same bytes.
#pragma once
#include <string>
#include <string_view>
#include "plugins/modeller/species.h"
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/random.h"

namespace coppice::modeller {

// What the plugin's interface calls.
Result<PlantDescription> grow_plant(std::string_view json, const std::string& file, uint64_t variation);

Result<PlantDescription> grow_tree(const TreeParameters& tree, const std::string& file, Random random);
PlantDescription grow_palm(const PalmParameters& palm, Random random);
PlantDescription grow_fern(const FrondParameters& fronds, Random random);
PlantDescription grow_grass(const GrassParameters& grass, Random random);
PlantDescription grow_flower(const FlowerParameters& flower, Random random);

}  // namespace coppice::modeller
