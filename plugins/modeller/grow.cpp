#include "plugins/modeller/grow.h"

#include "runtime/core/random.h"

namespace coppice::modeller {

Result<PlantDescription> grow_plant(std::string_view json, const std::string& file, uint64_t variation) {
    COPPICE_TRY(Species species, parse_species(json, file));
    Random random(species.seed, variation);
    PlantDescription plant;
    switch (species.form) {
        case PlantForm::tree: {
            COPPICE_TRY(plant, grow_tree(species.tree, file, random));
            break;
        }
        case PlantForm::palm:
            plant = grow_palm(species.palm, random);
            break;
        case PlantForm::fern:
            plant = grow_fern(species.palm.fronds, random);
            break;
        case PlantForm::grass:
            plant = grow_grass(species.grass, random);
            break;
        case PlantForm::flower:
            plant = grow_flower(species.flower, random);
            break;
    }
    plant.name = species.name;
    return plant;
}

}  // namespace coppice::modeller
