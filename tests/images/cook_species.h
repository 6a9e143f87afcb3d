// A species of the content, grown and cooked as players find it in their cache. CTest has each cooked once in a run, by the program,
// and says in which folder; without it, it is cooked here.
#pragma once
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/file.h"

namespace coppice {

inline Result<Plant> cook_species(const std::string& species) {
    if (const char* cooked = std::getenv("COPPICE_COOKED_SPECIES"))
        return load_plant(std::string(cooked) + "/" + species + ".plant");
    const std::string path = std::string(COPPICE_CONTENT_DIR) + "/species/" + species + ".json";
    COPPICE_TRY(const std::string text, read_text_file(path));
    COPPICE_TRY(const PlantDescription description, modeller::grow_plant(text, path, 0));
    COPPICE_TRY(std::vector<std::byte> bytes, cook_plant(description, {}));
    return load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(bytes)), species);
}

}  // namespace coppice
