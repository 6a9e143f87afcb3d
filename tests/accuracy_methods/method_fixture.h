// A small scene of two kinds of plants, cooked into a folder of its own, for the methods to draw.
#pragma once
#include <unistd.h>
#include <filesystem>
#include <gtest/gtest.h>
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "runtime/core/file.h"
#include "tests/cook/shapes.h"
#include "tools/accuracy/method.h"

namespace coppice {

// A stem that would become lines, and leaves that become points.
inline Result<PlantDescription> grow_small_tree(std::string_view, const std::string&, uint64_t variation) {
    PlantDescription plant;
    plant.name = "tree";
    plant.parts.resize(1);
    plant.parts[0].name = "stem";
    for (int i = 0; i < 3; ++i)
        shapes::add_tube(plant.parts[0],
                         shapes::straight_path(vec3(0.5f * float(i), 0, 0), vec3(0.5f * float(i), 4, 0), 8),
                         std::vector<float>(8, 0.03f));
    plant.parts.push_back(shapes::leaf_cloud(400, 1.5f, 0.15f, variation, vec3(0, 3, 0)));
    return plant;
}
inline constexpr ModellerInterface k_tree_modeller{sizeof(ModellerInterface), &grow_small_tree};

class MethodTest : public testing::Test {
  protected:
    MethodTest()
        : dir_(std::filesystem::temp_directory_path() / ("coppice_methods_" + std::to_string(::getpid()))) {
        std::filesystem::remove_all(dir_);
        std::filesystem::create_directories(dir_);
        std::string source = (dir_ / "tree.json").string();
        EXPECT_TRUE(write_text_file(source, "{}"));
        std::vector<PlantSource> sources;
        for (uint64_t variation : {1, 2}) {
            original_.scene.models.push_back({"tree " + std::to_string(variation), source, variation, 1.5f});
            sources.push_back({source, variation});
        }
        auto plants = find_or_cook(input().cache_dir, sources, {}, &k_tree_modeller, nullptr);
        EXPECT_TRUE(plants) << to_string(plants.error());
        original_.plants = std::move(*plants);
        // A row away from the origin: 2 m, 4 m, 8 m, ...
        std::vector<Placement> placements;
        for (uint32_t i = 0; i < 12; ++i) {
            double distance_m = double(2u << i);
            placements.push_back({dvec3(0, 0, -distance_m),
                                  1.0f + 0.1f * float(i % 3),
                                  pack_turn_about_y(float(i)),
                                  {i % 2, i * 77u}});
        }
        make_tiles(placements, original_.scene);
        finish_tiles(original_.scene, {{original_.plants[0].bounds_plant, original_.plants[1].bounds_plant}});
    }
    ~MethodTest() override { std::filesystem::remove_all(dir_); }

    MethodInput input() const { return {&original_, (dir_ / "cache").string(), &k_tree_modeller, nullptr}; }
    // Ready to draw.
    std::unique_ptr<AccuracyMethod> make(std::string_view name) const {
        for (auto& method : make_accuracy_methods())
            if (method->name() == name) {
                Status ready = method->prepare(input());
                EXPECT_TRUE(ready) << to_string(ready.error());
                return std::move(method);
            }
        ADD_FAILURE() << "no method " << name;
        return nullptr;
    }

    std::filesystem::path dir_;
    MethodScene original_;
};

}  // namespace coppice
