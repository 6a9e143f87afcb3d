// From an author's file to a packed plant: glTF (.glb, .gltf) by the importer, a species (.json) by the
// modeller plugin; and the cache of plants cooked before.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// The plant as described, with what is set of its parts beside it. variation: which individual of a species; glTF has one. modeller may be null where
// no species is read, images where no textures are. Errors: of the file, or name_unknown for a plugin that is
// needed and missing, format_unknown for another ending.
Result<PlantDescription> read_plant(const std::string& source_path, uint64_t variation,
                                    const ModellerInterface* modeller, const ImagesInterface* images);

// read_plant, cook_plant, and the packed plant written whole or not at all.
Status cook_file(const std::string& source_path, const std::string& out_path, uint64_t variation,
                 const CookSettings& settings, const ModellerInterface* modeller,
                 const ImagesInterface* images);

struct PlantSource {
    std::string path;  // .glb, .gltf, species .json; or .plant, which is loaded as it is
    uint64_t variation = 0;
    // In place of what stands beside the source (part_settings.h): what is being edited.
    std::optional<std::vector<PartSettings>> settings = {};
};

// Where the cache keeps the packed plant: its name follows from the bytes of the source and of the files it
// refers to, the variation, all settings and the versions of cook and modeller, so that what is found there
// is up to date. Nothing is cooked. Errors: file_*; of settings that stand beside it.
Result<std::string> cooked_path(const std::string& cache_dir, const PlantSource& source,
                                const CookSettings& settings);

// The packed plants of all sources, in their order, each loaded and checked once: from the cache, or cooked
// into it where it is missing there or cannot be loaded (which is noted). Where the cache cannot be written,
// plants stay in memory after one warning for all. Sources are cooked side by side; programs may race,
// because each writes a whole file. Errors: the first source's that has one.
Result<std::vector<Plant>> find_or_cook(const std::string& cache_dir, std::span<const PlantSource> sources,
                                        const CookSettings& settings, const ModellerInterface* modeller,
                                        const ImagesInterface* images);

}  // namespace coppice
