#include "tests/cook_import/tiny_gltf.h"

namespace coppice {
namespace {

Picture& test_picture() {
    static Picture picture;
    return picture;
}

}  // namespace

int TinyGltf::append(std::string& list, const std::string& item) {
    list += (list.empty() ? "" : ",") + item;
    return 0;
}

int TinyGltf::view(const void* bytes, size_t size_bytes, const std::string& more) {
    size_t offset = binary_.size();
    auto first = static_cast<const std::byte*>(bytes);
    binary_.insert(binary_.end(), first, first + size_bytes);
    binary_.resize((binary_.size() + 3) / 4 * 4);
    append(views_, "{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) + ",\"byteLength\":" +
                       std::to_string(size_bytes) + (more.empty() ? "" : "," + more) + "}");
    return view_count_++;
}

int TinyGltf::accessor(int view, int component_type, const std::string& type, size_t count,
                       const std::string& more) {
    append(accessors_, "{" + (view < 0 ? std::string() : "\"bufferView\":" + std::to_string(view) + ",") +
                           "\"componentType\":" + std::to_string(component_type) + ",\"type\":\"" + type +
                           "\",\"count\":" + std::to_string(count) + (more.empty() ? "" : "," + more) + "}");
    return accessor_count_++;
}

int TinyGltf::vectors(const std::vector<vec3>& values) {
    return accessor(view(values.data(), values.size() * sizeof(vec3)), 5126, "VEC3", values.size());
}
int TinyGltf::uvs(const std::vector<vec2>& values) {
    return accessor(view(values.data(), values.size() * sizeof(vec2)), 5126, "VEC2", values.size());
}
int TinyGltf::indices(const std::vector<uint32_t>& values) {
    return accessor(view(values.data(), values.size() * 4), 5125, "SCALAR", values.size());
}

int TinyGltf::mesh(const std::string& attributes, const std::string& primitive, const std::string& more) {
    append(meshes_, "{\"primitives\":[{\"attributes\":{" + attributes + "}" +
                        (primitive.empty() ? "" : "," + primitive) + "}]" + (more.empty() ? "" : "," + more) +
                        "}");
    return mesh_count_++;
}

std::string TinyGltf::json() const {
    auto list = [](const char* name, const std::string& items) {
        return items.empty() ? std::string() : std::string(",\"") + name + "\":[" + items + "]";
    };
    return "{\"asset\":{\"version\":\"2.0\"}" +
           (binary_.empty() ? "" : ",\"buffers\":[{\"byteLength\":" + std::to_string(binary_.size()) + "}]") +
           list("bufferViews", views_) + list("accessors", accessors_) + list("meshes", meshes_) +
           list("nodes", nodes_) + list("materials", materials_) + root_ + "}";
}

std::vector<std::byte> as_glb(const std::string& json, std::span<const std::byte> binary) {
    std::string text = json;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    uint32_t head[5] = {0x46546c67, 2, uint32_t(20 + text.size() + (binary.empty() ? 0 : 8 + binary.size())),
                        uint32_t(text.size()), 0x4e4f534a};
    std::vector<std::byte> bytes(sizeof head + text.size());
    std::memcpy(bytes.data(), head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, text.data(), text.size());
    if (!binary.empty()) {
        uint32_t chunk[2] = {uint32_t(binary.size()), 0x004e4942};
        auto first = reinterpret_cast<const std::byte*>(chunk);
        bytes.insert(bytes.end(), first, first + sizeof chunk);
        bytes.insert(bytes.end(), binary.begin(), binary.end());
    }
    return bytes;
}

std::vector<std::byte> TinyGltf::glb() const { return as_glb(json(), binary_); }

Result<PlantDescription> TinyGltf::import(const ImportSettings& settings) const {
    return import_gltf_memory(glb(), "tiny.glb", "", settings);
}

int add_triangle(TinyGltf& gltf, const std::string& primitive) {
    int positions = gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    return gltf.mesh("\"POSITION\":" + std::to_string(positions), primitive);
}

const ImagesInterface* test_images() {
    static const ImagesInterface images = [] {
        ImagesInterface made{};
        made.size_bytes = sizeof made;
        made.read_memory = [](std::span<const std::byte>, const std::string&) -> Result<Picture> {
            return test_picture();
        };
        return made;
    }();
    return &images;
}

void set_test_picture(uint32_t width, uint32_t height,
                      const std::function<void(uint32_t, uint32_t, uint8_t*)>& paint) {
    Picture& picture = test_picture();
    picture.width = width;
    picture.height = height;
    picture.rgba.assign(size_t(width) * height * 4, 0);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) paint(x, y, &picture.rgba[(size_t(y) * width + x) * 4]);
}

double area_of(const PartDescription& part) {
    double area = 0.0;
    for (size_t i = 0; i < part.indices.size(); i += 3) {
        vec3 a = part.vertices[part.indices[i]].position_plant,
             b = part.vertices[part.indices[i + 1]].position_plant,
             c = part.vertices[part.indices[i + 2]].position_plant;
        area += glm::length(glm::cross(b - a, c - a)) * 0.5;
    }
    return area;
}

vec3 mean_color_of(const PartDescription& part) {
    vec3 sum(0.0f);
    float area = 0.0f;
    for (size_t i = 0; i < part.indices.size(); i += 3) {
        const auto &a = part.vertices[part.indices[i]], &b = part.vertices[part.indices[i + 1]],
                   &c = part.vertices[part.indices[i + 2]];
        float weight =
            glm::length(glm::cross(b.position_plant - a.position_plant, c.position_plant - a.position_plant));
        sum += (a.color_linear + b.color_linear + c.color_linear) * (weight / 3.0f);
        area += weight;
    }
    return sum * (1.0f / area);
}

}  // namespace coppice
