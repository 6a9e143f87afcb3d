#include "plugins/vegetation/cook/import/import_gltf.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include "plugins/vegetation/cook/import/average_colors.h"
#include "plugins/vegetation/cook/import/divide_edges.h"
#include "plugins/vegetation/cook/import/find_elements.h"
#include "plugins/vegetation/cook/import/gltf_buffers.h"
#include "plugins/vegetation/cook/import/gltf_primitive.h"
#include "plugins/vegetation/cook/import/gltf_scene.h"
#include "plugins/vegetation/cook/import/gltf_uri.h"
#include "plugins/vegetation/cook/import/texture_pyramid.h"
#include "runtime/core/log.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

constexpr size_t k_placement_limit = size_t(1) << 20;
constexpr size_t k_piece_limit = size_t(1) << 20;  // primitives, once for each place
constexpr size_t k_least_added = 2000;             // triangles that dividing may add to any plant

bool names_any(const std::string& name, std::initializer_list<std::string_view> words) {
    std::string lower = name;
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return std::any_of(words.begin(), words.end(),
                       [&lower](std::string_view word) { return lower.find(word) != std::string::npos; });
}

bool guess_leaf(const GltfMaterial* material, const std::string& mesh_name, const std::string& node_name) {
    for (const std::string& name : {material ? material->name : std::string(), mesh_name, node_name}) {
        if (names_any(name, {"leaf", "leav", "needle", "petal", "flower", "blossom", "grass", "frond", "fern",
                             "foliage"}))
            return true;
        if (names_any(name, {"bark", "trunk", "branch", "stem", "stalk", "twig", "wood", "root"}))
            return false;
    }
    return material && (material->masked || material->double_sided);
}

// What makes two primitives one part.
struct PartKey {
    std::string name;
    PartKind kind;
    bool leaf;
    float importance;
    bool operator<(const PartKey& other) const {
        return std::tie(name, kind, leaf, importance) <
               std::tie(other.name, other.kind, other.leaf, other.importance);
    }
};

// A primitive at its place, waiting for its texture (k_gltf_none: it has its colours).
struct Piece {
    ImportMesh mesh;
    uint32_t part;
    uint32_t texture;
};

class Importer {
  public:
    Importer(GltfDocument document, GltfBuffers buffers, std::string base_dir, const ImportSettings& settings)
        : document_(std::move(document)),
          buffers_(std::move(buffers)),
          base_dir_(std::move(base_dir)),
          settings_(settings) {}

    Result<PlantDescription> run(const std::string& plant_name) {
        COPPICE_TRY(auto placements, place_meshes(document_, buffers_, k_placement_limit));
        masked_triangle_count_ = count_masked_triangles(placements);
        uint32_t loaded_mesh = k_gltf_none;
        std::vector<Prepared> prepared;
        for (const GltfPlacement& placement : placements) {
            if (placement.mesh != loaded_mesh) {
                COPPICE_TRY(prepared, prepare_mesh(placement.mesh));
                loaded_mesh = placement.mesh;
            }
            for (size_t p = 0; p < prepared.size(); ++p)
                COPPICE_CHECK(place_piece(placement, p, prepared[p]));
        }
        if (skipped_primitives_)
            log_note("{}: {} primitives of points or lines are left out", document_.file,
                     skipped_primitives_);
        if (triangle_count_ == 0)
            return fail(
                ErrorId::value_out_of_range, document_.file, "",
                "no triangles; " + std::to_string(placements.size()) + " meshes are placed in the scene",
                "at least one mesh of triangles in the default scene");
        return assemble(plant_name);
    }

  private:
    struct Prepared {
        ImportMesh mesh;  // mesh space
        uint32_t texture = k_gltf_none;
    };

    std::string primitive_place(uint32_t mesh, size_t primitive) const {
        return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
    }

    // Of all places together, as far as the file's counts can be believed: the cards' triangle target is
    // dealt out by it.
    size_t count_masked_triangles(const std::vector<GltfPlacement>& placements) const {
        size_t count = 0;
        for (const GltfPlacement& placement : placements)
            for (const GltfPrimitive& primitive : document_.meshes[placement.mesh].primitives) {
                if (primitive.material == k_gltf_none || !document_.materials[primitive.material].masked)
                    continue;
                uint32_t corners = primitive.indices != k_gltf_none ? primitive.indices : primitive.position;
                if (corners != k_gltf_none) count += document_.accessors[corners].count / 3;
            }
        return std::max<size_t>(count, 1);
    }

    Result<const Picture*> load_picture(uint32_t index) {
        auto found = pictures_.find(index);
        if (found != pictures_.end()) return &found->second;
        const GltfImage& image = document_.images[index];
        bool embedded = !image.uri || is_data_uri(*image.uri);
        std::string label = !image.name.empty() ? image.name : embedded ? std::string() : *image.uri;
        std::string place =
            "images[" + std::to_string(index) + "]" + (label.empty() ? "" : " \"" + label + "\"");
        if (!settings_.images)
            return fail(ErrorId::file_unreadable, document_.file, place,
                        "the picture cannot be read without the images plugin",
                        "install the plugin \"images\", or export vertex colours instead of textures");
        Result<Picture> picture = read_picture(image, place);
        if (!picture) {
            Error error = std::move(picture.error());
            error.place = place + (error.place.empty() || error.place == place ? "" : ", " + error.place);
            error.file = document_.file;
            return fail(std::move(error));
        }
        if (picture->empty() || picture->rgba.size() != size_t(picture->width) * picture->height * 4)
            return fail(ErrorId::file_corrupt, document_.file, place, "the picture is empty",
                        "a picture of at least one texel");
        return &pictures_.emplace(index, std::move(*picture)).first->second;
    }

    Result<Picture> read_picture(const GltfImage& image, const std::string& place) const {
        if (!image.uri) return settings_.images->read_memory(buffers_.view(image.view), document_.file);
        if (is_data_uri(*image.uri)) {
            COPPICE_TRY(auto bytes, decode_data_uri(*image.uri, document_.file, place));
            return settings_.images->read_memory(bytes, document_.file);
        }
        COPPICE_TRY(std::string path, resolve_uri(*image.uri, base_dir_, document_.file, place));
        auto file = MappedFile::open(path);
        if (!file)
            return fail(file.error().id, document_.file, place, "\"" + path + "\": " + file.error().fault,
                        "the picture beside the document");
        if (file->bytes().size() > settings_.size_limit_bytes)
            return fail(ErrorId::limit_exceeded, document_.file, place, "the picture's file is too large",
                        "at most " + std::to_string(settings_.size_limit_bytes) + " bytes");
        return settings_.images->read_memory(file->bytes(), path);
    }

    // Reads the primitives of a mesh once, however often it is placed, and cuts its cards.
    Result<std::vector<Prepared>> prepare_mesh(uint32_t mesh_index) {
        std::vector<Prepared> prepared;
        const GltfMesh& mesh = document_.meshes[mesh_index];
        bool is_new = counted_meshes_.insert(mesh_index).second;
        size_t triangles_left = settings_.triangle_limit - triangle_count_;
        for (size_t p = 0; p < mesh.primitives.size(); ++p) {
            const GltfPrimitive& primitive = mesh.primitives[p];
            if (is_new && primitive.mode == GltfPrimitive::Mode::other) ++skipped_primitives_;
            Prepared& ready = prepared.emplace_back();
            COPPICE_TRY(ready.mesh,
                        read_primitive_mesh(document_, buffers_, primitive, primitive_place(mesh_index, p),
                                            triangles_left, settings_.vertex_limit));
            triangles_left -= ready.mesh.triangle_count();
            if (is_new) dropped_vertices_ += ready.mesh.dropped_vertices;
            find_elements(ready.mesh);
            if (primitive.material == k_gltf_none || ready.mesh.indices.empty()) continue;
            COPPICE_CHECK(apply_alpha(document_.materials[primitive.material], primitive.material, ready));
        }
        return prepared;
    }

    Status apply_alpha(const GltfMaterial& material, uint32_t material_index, Prepared& ready) {
        uint32_t texture = material.base_texture.texture;
        ready.texture = texture;
        // Alpha is texture x factor; what must the texture's be to be opaque?
        float factor = material.base_color_linear.w;
        float opaque_alpha = !material.masked ? 0.0f
                             : factor > 0.0f  ? material.alpha_cutoff / factor * 255.0f
                                              : 256.0f;
        if (material.masked && material.alpha_cutoff <= 0.0f) opaque_alpha = 0.0f;
        if (opaque_alpha > 255.0f) {
            log_note("{}: materials[{}] is transparent everywhere; its triangles are left out",
                     document_.file, material_index);
            ready = Prepared();
            return {};
        }
        if (texture == k_gltf_none) return {};
        uint32_t image = document_.textures[texture].image;
        if (image == k_gltf_none)
            return fail(ErrorId::format_unknown, document_.file, "textures[" + std::to_string(texture) + "]",
                        "the texture has no picture in a format that is read here", "PNG, JPEG or WebP");
        COPPICE_TRY(const Picture* picture, load_picture(image));
        if (opaque_alpha <= 0.0f) return {};
        bool all_opaque = true;
        for (size_t i = 3; all_opaque && i < picture->rgba.size(); i += 4)
            all_opaque = float(picture->rgba[i]) >= opaque_alpha;
        if (all_opaque) {
            if (whole_materials_.insert(material_index).second)
                log_warning(
                    "{}: materials[{}] \"{}\" is alpha-masked, but images[{}] has no transparent texel: its "
                    "cards stay whole",
                    document_.file, material_index, material.name, image);
            return {};
        }
        const GltfTexture& wraps = document_.textures[texture];
        AlphaCutSettings share = settings_.alpha_cut;
        share.triangle_target =
            uint32_t(uint64_t(share.triangle_target) * ready.mesh.triangle_count() / masked_triangle_count_);
        ready.mesh = cut_alpha(ready.mesh, *picture, wraps.wrap_s, wraps.wrap_t, opaque_alpha, share);
        ready.texture = k_gltf_none;
        return {};
    }

    uint32_t find_part(const GltfPlacement& placement, size_t primitive_index) {
        const GltfNode& node = document_.nodes[placement.node];
        const GltfMesh& mesh = document_.meshes[placement.mesh];
        uint32_t material_index = mesh.primitives[primitive_index].material;
        const GltfMaterial* material =
            material_index == k_gltf_none ? nullptr : &document_.materials[material_index];
        PartKey key{material ? material->name : "", PartKind::automatic,
                    guess_leaf(material, mesh.name, node.name), 0.0f};
        if (key.name.empty()) key.name = !mesh.name.empty() ? mesh.name : node.name;
        if (key.name.empty()) key.name = "part";
        for (const GltfHints* hints : {material ? &material->hints : nullptr, &mesh.hints, &node.hints}) {
            if (!hints) continue;
            key.kind = hints->kind.value_or(key.kind);
            key.importance = hints->importance.value_or(key.importance);
            key.leaf = hints->leaf.value_or(key.leaf);
        }
        auto [found, is_new] = part_of_key_.try_emplace(key, uint32_t(parts_.size()));
        if (is_new) {
            PartDescription& part = parts_.emplace_back();
            part.name = key.name;
            uint32_t namesakes = ++name_uses_[key.name];
            if (namesakes > 1) part.name += " " + std::to_string(namesakes);
            part.kind = key.kind;
            part.leaf = key.leaf;
            part.importance = key.importance;
        }
        return found->second;
    }

    Status place_piece(const GltfPlacement& placement, size_t primitive, const Prepared& prepared) {
        if (prepared.mesh.indices.empty()) return {};
        std::string place = primitive_place(placement.mesh, primitive);
        if (prepared.mesh.triangle_count() > settings_.triangle_limit - triangle_count_)
            return fail(ErrorId::limit_exceeded, document_.file, place, "too many triangles",
                        "at most " + std::to_string(settings_.triangle_limit) + " in a plant");
        if (prepared.mesh.positions_plant.size() > settings_.vertex_limit - vertex_count_)
            return fail(ErrorId::limit_exceeded, document_.file, place, "too many vertices",
                        "at most " + std::to_string(settings_.vertex_limit) + " in a plant");
        if (pieces_.size() == k_piece_limit)
            return fail(
                ErrorId::limit_exceeded, document_.file, place, "too many primitives, each place counted",
                "at most " + std::to_string(k_piece_limit) + " in a plant; join them in the modelling tool");
        triangle_count_ += prepared.mesh.triangle_count();
        vertex_count_ += prepared.mesh.positions_plant.size();
        COPPICE_TRY(ImportMesh mesh,
                    transform_mesh(prepared.mesh, placement.plant_from_mesh, document_.file, place));
        pieces_.push_back({std::move(mesh), find_part(placement, primitive), prepared.texture});
        return {};
    }

    Result<PlantDescription> assemble(const std::string& plant_name) {
        std::vector<TexturedMesh> textured;
        for (Piece& piece : pieces_) {
            if (piece.texture == k_gltf_none) continue;
            const Picture& picture = pictures_.at(document_.textures[piece.texture].image);
            textured.push_back({&piece.mesh, vec2(float(picture.width), float(picture.height))});
        }
        // A small plant stays small.
        divide_long_edges(textured, settings_.texture_detail_m,
                          std::min<size_t>(settings_.added_triangle_limit, k_least_added + triangle_count_));

        std::map<uint32_t, TexturePyramid> pyramids;
        std::vector<uint32_t> element_counts(parts_.size(), 0);
        std::vector<std::vector<uint32_t>> elements(parts_.size());
        for (Piece& piece : pieces_) {
            if (piece.texture != k_gltf_none) {
                const GltfTexture& texture = document_.textures[piece.texture];
                auto pyramid = pyramids.find(piece.texture);
                if (pyramid == pyramids.end())
                    pyramid = pyramids
                                  .emplace(piece.texture, TexturePyramid(pictures_.at(texture.image),
                                                                         texture.wrap_s, texture.wrap_t, 0))
                                  .first;
                auto colors = average_colors(pyramid->second, piece.mesh.uvs, piece.mesh.indices);
                for (size_t v = 0; v < colors.size(); ++v) piece.mesh.colors_linear[v] *= colors[v];
            }
            PartDescription& part = parts_[piece.part];
            uint32_t first_vertex = uint32_t(part.vertices.size());
            for (size_t v = 0; v < piece.mesh.positions_plant.size(); ++v)
                part.vertices.push_back({piece.mesh.positions_plant[v], piece.mesh.normals_plant[v],
                                         glm::clamp(piece.mesh.colors_linear[v], vec3(0.0f), vec3(1.0f))});
            for (uint32_t index : piece.mesh.indices) part.indices.push_back(first_vertex + index);
            for (uint32_t element : piece.mesh.elements)
                elements[piece.part].push_back(element_counts[piece.part] + element);
            element_counts[piece.part] += piece.mesh.element_count;
            piece.mesh = ImportMesh();
        }
        for (size_t p = 0; p < parts_.size(); ++p)
            if (parts_[p].leaf) group_by_element(parts_[p], elements[p], element_counts[p]);
        return PlantDescription{plant_name, std::move(parts_), {},
                                uint32_t(std::min<uint64_t>(dropped_vertices_, UINT32_MAX))};
    }

    // Triangles of one element next to each other, elements in order. Elements that lost all their triangles
    // go.
    static void group_by_element(PartDescription& part, const std::vector<uint32_t>& elements,
                                 uint32_t element_count) {
        std::vector<uint32_t> first(element_count + 1, 0);
        for (uint32_t element : elements) ++first[element + 1];
        for (uint32_t e = 0; e < element_count; ++e) first[e + 1] += first[e];
        std::vector<uint32_t> indices(part.indices.size()), next = first;
        for (size_t t = 0; t < elements.size(); ++t) {
            uint32_t to = next[elements[t]]++;
            for (size_t c = 0; c < 3; ++c) indices[size_t(to) * 3 + c] = part.indices[t * 3 + c];
        }
        first.erase(std::unique(first.begin(), first.end()), first.end());
        part.indices = std::move(indices);
        part.element_first_triangle = std::move(first);
    }

    GltfDocument document_;
    GltfBuffers buffers_;
    std::string base_dir_;
    const ImportSettings& settings_;
    std::map<uint32_t, Picture> pictures_;  // by image
    std::map<PartKey, uint32_t> part_of_key_;
    std::map<std::string, uint32_t> name_uses_;
    std::vector<PartDescription> parts_;
    std::vector<Piece> pieces_;
    size_t triangle_count_ = 0, vertex_count_ = 0, masked_triangle_count_ = 1;
    uint64_t dropped_vertices_ = 0;
    std::set<uint32_t> counted_meshes_;   // their dropped vertices and skipped primitives count once
    std::set<uint32_t> whole_materials_;  // masked, but nothing to cut
    size_t skipped_primitives_ = 0;
};

}  // namespace

Result<PlantDescription> import_gltf_memory(std::span<const std::byte> bytes, const std::string& name,
                                            const std::string& base_dir, const ImportSettings& settings) {
    try {
        if (bytes.size() > settings.size_limit_bytes)
            return fail(ErrorId::limit_exceeded, name, "",
                        "the file has " + std::to_string(bytes.size()) + " bytes",
                        "at most " + std::to_string(settings.size_limit_bytes));
        GlbChunks chunks{std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), {}};
        if (is_glb(bytes)) {
            COPPICE_TRY(chunks, split_glb(bytes, name));
        }
        COPPICE_TRY(GltfDocument document, parse_gltf(chunks.json, name));
        COPPICE_TRY(GltfBuffers buffers,
                    GltfBuffers::load(document, chunks.binary, base_dir, settings.size_limit_bytes));
        return Importer(std::move(document), std::move(buffers), base_dir, settings)
            .run(std::filesystem::path(name).stem().string());
    } catch (const std::bad_alloc&) {
        return fail(ErrorId::limit_exceeded, name, "", "not enough memory to import it", "a smaller file");
    } catch (const std::exception& thrown) {
        return fail(ErrorId::file_corrupt, name, "", std::string("cannot be imported: ") + thrown.what(),
                    "a valid glTF file");
    }
}

Result<PlantDescription> import_gltf(const std::string& path, const ImportSettings& settings) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    return import_gltf_memory(file.bytes(), path, std::filesystem::path(path).parent_path().string(),
                              settings);
}

}  // namespace coppice
