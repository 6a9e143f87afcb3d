// Builds small GLB files in memory, one call a feature.
#pragma once
#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>
#include "plugins/vegetation/cook/import/import_gltf.h"

namespace coppice {

class TinyGltf {
  public:
    // Appends to the binary chunk, aligned to 4. Returns the index of the new buffer view.
    int view(const void* bytes, size_t size_bytes, const std::string& more = "");
    // Returns the index of the new accessor: more is JSON such as "\"normalized\":true".
    int accessor(int view, int component_type, const std::string& type, size_t count,
                 const std::string& more = "");
    int positions(const std::vector<vec3>& values) { return vectors(values); }
    int vectors(const std::vector<vec3>& values);
    int uvs(const std::vector<vec2>& values);
    int indices(const std::vector<uint32_t>& values);
    // A node with a mesh of one primitive; each text is the inside of a JSON object. Returns the mesh.
    int mesh(const std::string& attributes, const std::string& primitive = "", const std::string& more = "");
    void node(const std::string& inside) { append(nodes_, "{" + inside + "}"); }
    void material(const std::string& inside) { append(materials_, "{" + inside + "}"); }
    // "\"scenes\":[...]" and the like
    void root(const std::string& member) { root_ += "," + member; }

    std::string json() const;
    std::vector<std::byte> glb() const;
    Result<PlantDescription> import(const ImportSettings& settings = {}) const;

  private:
    static int append(std::string& list, const std::string& item);
    std::vector<std::byte> binary_;
    std::string views_, accessors_, meshes_, nodes_, materials_, root_;
    int view_count_ = 0, accessor_count_ = 0, mesh_count_ = 0;
};

// One triangle (0,0,0) (1,0,0) (0,1,0), ready to be placed by nodes.
int add_triangle(TinyGltf& gltf, const std::string& primitive = "");

std::vector<std::byte> as_glb(const std::string& json, std::span<const std::byte> binary);

// An images interface whose pictures are functions: read_memory gives what set_test_picture was given.
const ImagesInterface* test_images();
void set_test_picture(uint32_t width, uint32_t height,
                      const std::function<void(uint32_t x, uint32_t y, uint8_t* rgba)>& paint);

double area_of(const PartDescription& part);
vec3 mean_color_of(const PartDescription& part);

}  // namespace coppice
