#include "plugins/vegetation/cook/import/gltf_document.h"

#include <algorithm>
#include "plugins/vegetation/cook/import/compose_transform.h"
#include "plugins/vegetation/cook/import/json_place.h"

namespace coppice {
namespace {

constexpr int k_depth_limit = 64;
constexpr uint64_t k_size_limit_bytes = uint64_t(1)
                                        << 40;  // of numbers in the file; what is loaded is limited later
constexpr uint64_t k_count_limit = uint64_t(1) << 28;  // elements of an accessor

// Extensions a file may require of us: those we read, and those that change neither shape nor base colour.
constexpr std::string_view k_known_extensions[] = {"KHR_mesh_quantization",
                                                   "EXT_meshopt_compression",
                                                   "KHR_texture_transform",
                                                   "EXT_mesh_gpu_instancing",
                                                   "EXT_texture_webp",
                                                   "KHR_lights_punctual",
                                                   "KHR_xmp_json_ld",
                                                   "KHR_xmp",
                                                   "KHR_draco_mesh_compression",
                                                   "KHR_animation_pointer",
                                                   "KHR_node_visibility"};

bool is_known_extension(std::string_view name) {
    return name.starts_with("KHR_materials_") ||
           std::find(std::begin(k_known_extensions), std::end(k_known_extensions), name) !=
               std::end(k_known_extensions);
}

GltfHints read_hints(const JsonPlace& owner) {
    GltfHints hints;
    // extras may be any JSON; only an object with our name in it is ours.
    JsonPlace ours = owner.object_or_nothing("extras").object("coppice");
    if (!ours.present()) return hints;
    if (auto kind = ours.text("kind")) {
        if (*kind == "points")
            hints.kind = PartKind::points;
        else if (*kind == "lines")
            hints.kind = PartKind::lines;
        else if (*kind == "automatic")
            hints.kind = PartKind::automatic;
        else
            ours.fault(ErrorId::name_unknown, "kind \"" + kind->substr(0, 40) + "\"",
                       "\"points\", \"lines\" or \"automatic\"");
    }
    if (ours.has("importance")) {
        float importance = ours.number("importance", 1.0f);
        if (importance > 0.0f && importance <= 1000.0f)
            hints.importance = importance;
        else
            ours.fault(ErrorId::value_out_of_range, "importance " + std::to_string(importance),
                       "above 0, at most 1000");
    }
    if (ours.has("leaf")) hints.leaf = ours.flag("leaf", false);
    return hints;
}

void read_asset(const JsonPlace& root) {
    JsonPlace asset = root.object("asset");
    std::string version = asset.text("version").value_or("");
    if (!version.starts_with("2.") || asset.text("minVersion").value_or("2.0") != "2.0")
        root.fault(ErrorId::format_unknown, "asset.version is \"" + version.substr(0, 20) + "\"",
                   "a glTF file of version 2.0");
    for (const JsonPlace& item : root.array("extensionsRequired")) {
        std::string name = item.as_text().value_or("");
        if (!is_known_extension(name))
            item.fault(ErrorId::format_unknown,
                       "the file requires the extension \"" + name.substr(0, 80) + "\"",
                       "export it without this extension");
    }
}

GltfBuffer read_buffer(const JsonPlace& from) {
    GltfBuffer buffer;
    buffer.uri = from.text("uri");
    buffer.size_bytes = from.whole("byteLength", std::nullopt, 1, k_size_limit_bytes);
    return buffer;
}

GltfMeshopt read_meshopt(const JsonPlace& from, size_t buffer_count) {
    GltfMeshopt packed;
    packed.buffer = from.needed_index("buffer", buffer_count);
    packed.offset_bytes = from.whole("byteOffset", 0, 0, k_size_limit_bytes);
    packed.size_bytes = from.whole("byteLength", std::nullopt, 1, k_size_limit_bytes);
    packed.stride_bytes = uint32_t(from.whole("byteStride", std::nullopt, 1, 256));
    packed.count = from.whole("count", std::nullopt, 1, k_count_limit);
    std::string mode = from.text("mode").value_or(""), filter = from.text("filter").value_or("NONE");
    using Mode = GltfMeshopt::Mode;
    using Filter = GltfMeshopt::Filter;
    if (mode == "ATTRIBUTES")
        packed.mode = Mode::attributes;
    else if (mode == "TRIANGLES")
        packed.mode = Mode::triangles;
    else if (mode == "INDICES")
        packed.mode = Mode::indices;
    else
        from.fault(ErrorId::value_out_of_range, "mode \"" + mode.substr(0, 40) + "\"",
                   "ATTRIBUTES, TRIANGLES or INDICES");
    if (filter == "NONE")
        packed.filter = Filter::none;
    else if (filter == "OCTAHEDRAL")
        packed.filter = Filter::octahedral;
    else if (filter == "QUATERNION")
        packed.filter = Filter::quaternion;
    else if (filter == "EXPONENTIAL")
        packed.filter = Filter::exponential;
    else
        from.fault(ErrorId::value_out_of_range, "filter \"" + filter.substr(0, 40) + "\"",
                   "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
    // What the decoder takes for granted.
    uint32_t stride = packed.stride_bytes;
    bool fits = packed.mode == Mode::attributes
                    ? stride % 4 == 0
                    : (stride == 2 || stride == 4) && packed.filter == Filter::none;
    if (packed.mode == Mode::triangles) fits = fits && packed.count % 3 == 0;
    if (packed.filter == Filter::octahedral) fits = fits && (stride == 4 || stride == 8);
    if (packed.filter == Filter::quaternion) fits = fits && stride == 8;
    if (!fits)
        from.fault(ErrorId::value_out_of_range,
                   "byteStride " + std::to_string(stride) + " and count " + std::to_string(packed.count) +
                       " do not fit the mode and filter",
                   "what EXT_meshopt_compression allows");
    return packed;
}

GltfBufferView read_view(const JsonPlace& from, size_t buffer_count) {
    GltfBufferView view;
    view.buffer = from.needed_index("buffer", buffer_count);
    view.offset_bytes = from.whole("byteOffset", 0, 0, k_size_limit_bytes);
    view.size_bytes = from.whole("byteLength", std::nullopt, 1, k_size_limit_bytes);
    if (from.has("byteStride")) view.stride_bytes = uint32_t(from.whole("byteStride", 4, 4, 252));
    if (view.stride_bytes % 4 != 0)
        from.fault(ErrorId::value_out_of_range, "byteStride " + std::to_string(view.stride_bytes),
                   "a multiple of 4");
    JsonPlace meshopt = from.object("extensions").object("EXT_meshopt_compression");
    if (meshopt.present()) {
        view.meshopt = read_meshopt(meshopt, buffer_count);
        if (view.size_bytes != view.meshopt->count * view.meshopt->stride_bytes)
            meshopt.fault(
                ErrorId::value_out_of_range,
                "count x byteStride is not the byteLength of the view, " + std::to_string(view.size_bytes),
                "equal sizes");
        view.stride_bytes =
            view.meshopt->mode == GltfMeshopt::Mode::attributes ? view.meshopt->stride_bytes : 0;
    }
    return view;
}

uint32_t read_component_type(const JsonPlace& from) {
    uint32_t type = uint32_t(from.whole("componentType", std::nullopt, k_gltf_byte, k_gltf_float));
    if (type == 5124)
        from.fault(ErrorId::value_out_of_range, "componentType 5124", "5120, 5121, 5122, 5123, 5125 or 5126");
    return type;
}

GltfAccessor read_accessor(const JsonPlace& from, size_t view_count) {
    GltfAccessor accessor;
    accessor.view = from.index("bufferView", view_count);
    accessor.offset_bytes = from.whole("byteOffset", 0, 0, k_size_limit_bytes);
    accessor.count = from.whole("count", std::nullopt, 1, k_count_limit);
    accessor.component_type = read_component_type(from);
    accessor.normalized = from.flag("normalized", false);
    std::string type = from.text("type").value_or("");
    if (type == "SCALAR")
        accessor.components = 1;
    else if (type == "VEC2")
        accessor.components = 2;
    else if (type == "VEC3")
        accessor.components = 3;
    else if (type == "VEC4" || type == "MAT2")
        accessor.components = 4;
    else if (type == "MAT3")
        accessor.components = 9;
    else if (type == "MAT4")
        accessor.components = 16;
    else
        from.fault(ErrorId::value_out_of_range, "type \"" + type.substr(0, 40) + "\"",
                   "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    JsonPlace sparse = from.object("sparse");
    if (sparse.present()) {
        GltfSparse patch;
        patch.count = sparse.whole("count", std::nullopt, 1, accessor.count);
        JsonPlace indices = sparse.object("indices"), values = sparse.object("values");
        if (!indices.present() || !values.present())
            sparse.fault(ErrorId::syntax, "indices or values are missing", "both are required");
        patch.indices_view = indices.needed_index("bufferView", view_count);
        patch.indices_offset_bytes = indices.whole("byteOffset", 0, 0, k_size_limit_bytes);
        if (indices.present()) patch.indices_type = read_component_type(indices);
        patch.values_view = values.needed_index("bufferView", view_count);
        patch.values_offset_bytes = values.whole("byteOffset", 0, 0, k_size_limit_bytes);
        accessor.sparse = patch;
    }
    return accessor;
}

GltfWrap read_wrap(const JsonPlace& sampler, const char* key) {
    uint64_t value = sampler.whole(key, 10497, 0, UINT32_MAX);
    if (value == 33071) return GltfWrap::clamp;
    if (value == 33648) return GltfWrap::mirror;
    if (value != 10497)
        sampler.fault(ErrorId::value_out_of_range, std::string(key) + " " + std::to_string(value),
                      "10497, 33071 or 33648");
    return GltfWrap::repeat;
}

GltfTexture read_texture(const JsonPlace& from, size_t image_count, const std::vector<JsonPlace>& samplers) {
    GltfTexture texture;
    texture.image = from.index("source", image_count);
    if (texture.image == k_gltf_none)
        texture.image = from.object("extensions").object("EXT_texture_webp").index("source", image_count);
    uint32_t sampler = from.index("sampler", samplers.size());
    if (sampler != k_gltf_none && sampler < samplers.size()) {
        texture.wrap_s = read_wrap(samplers[sampler], "wrapS");
        texture.wrap_t = read_wrap(samplers[sampler], "wrapT");
    }
    return texture;
}

GltfTextureUse read_texture_use(const JsonPlace& from, size_t texture_count) {
    GltfTextureUse use;
    if (!from.present()) return use;
    use.texture = from.needed_index("index", texture_count);
    if (texture_count == 0) use.texture = k_gltf_none;
    use.texcoord = uint32_t(from.whole("texCoord", 0, 0, 15));
    JsonPlace transform = from.object("extensions").object("KHR_texture_transform");
    if (transform.present()) {
        transform.numbers("offset", &use.offset.x, 2);
        transform.numbers("scale", &use.scale.x, 2);
        use.rotation_rad = transform.number("rotation", 0.0f);
        use.texcoord = uint32_t(transform.whole("texCoord", use.texcoord, 0, 15));
    }
    return use;
}

GltfMaterial read_material(const JsonPlace& from, size_t texture_count) {
    GltfMaterial material;
    material.name = from.text("name").value_or("");
    JsonPlace base = from.object("pbrMetallicRoughness");
    base.numbers("baseColorFactor", &material.base_color_linear.x, 4);
    material.base_texture = read_texture_use(base.object("baseColorTexture"), texture_count);
    // The older way of saying it, which many scanned plants still use.
    JsonPlace gloss = from.object("extensions").object("KHR_materials_pbrSpecularGlossiness");
    if (gloss.present()) {
        gloss.numbers("diffuseFactor", &material.base_color_linear.x, 4);
        if (gloss.has("diffuseTexture"))
            material.base_texture = read_texture_use(gloss.object("diffuseTexture"), texture_count);
    }
    material.base_color_linear = glm::clamp(material.base_color_linear, vec4(0.0f), vec4(1.0f));
    std::string mode = from.text("alphaMode").value_or("OPAQUE");
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
        from.fault(ErrorId::value_out_of_range, "alphaMode \"" + mode.substr(0, 40) + "\"",
                   "OPAQUE, MASK or BLEND");
    material.masked = mode != "OPAQUE";
    if (mode == "MASK") material.alpha_cutoff = from.number("alphaCutoff", 0.5f);
    if (material.alpha_cutoff < 0.0f)
        from.fault(ErrorId::value_out_of_range, "a negative alphaCutoff", "at least 0");
    material.double_sided = from.flag("doubleSided", false);
    material.hints = read_hints(from);
    return material;
}

GltfPrimitive read_primitive(const JsonPlace& from, size_t accessor_count, size_t material_count) {
    GltfPrimitive primitive;
    using Mode = GltfPrimitive::Mode;
    uint64_t mode = from.whole("mode", 4, 0, 6);
    primitive.mode = mode == 4   ? Mode::triangles
                     : mode == 5 ? Mode::strip
                     : mode == 6 ? Mode::fan
                                 : Mode::other;
    primitive.indices = from.index("indices", accessor_count);
    primitive.material = from.index("material", material_count);
    primitive.draco = from.object("extensions").has("KHR_draco_mesh_compression");
    JsonPlace attributes = from.object("attributes");
    if (!attributes.present()) from.fault(ErrorId::syntax, "attributes are missing", "at least POSITION");
    primitive.position = attributes.index("POSITION", accessor_count);
    primitive.normal = attributes.index("NORMAL", accessor_count);
    primitive.color = attributes.index("COLOR_0", accessor_count);
    for (int n = 0; n < 16; ++n) {
        uint32_t accessor = attributes.index(("TEXCOORD_" + std::to_string(n)).c_str(), accessor_count);
        if (accessor == k_gltf_none) break;
        primitive.texcoords.push_back(accessor);
    }
    return primitive;
}

mat4 read_transform(const JsonPlace& from) {
    bool parts = from.has("translation") || from.has("rotation") || from.has("scale");
    mat4 m(1.0f);
    if (from.has("matrix")) {
        if (parts)
            from.fault(ErrorId::value_out_of_range, "both a matrix and translation, rotation or scale",
                       "one of the two");
        from.numbers("matrix", &m[0].x, 16);
        if (m[0].w != 0.0f || m[1].w != 0.0f || m[2].w != 0.0f || m[3].w != 1.0f)
            from.fault(ErrorId::value_out_of_range, "a matrix whose last row is not 0 0 0 1",
                       "an affine transform");
        return m;
    }
    vec3 translation(0.0f), scale(1.0f);
    vec4 q(0, 0, 0, 1);
    from.numbers("translation", &translation.x, 3);
    from.numbers("rotation", &q.x, 4);
    from.numbers("scale", &scale.x, 3);
    float length = std::sqrt(glm::dot(q, q));
    if (!(length > 0.9f && length < 1.1f))
        from.fault(ErrorId::value_out_of_range, "a rotation of length " + std::to_string(length),
                   "a unit quaternion");
    return compose_transform(translation, q, scale);
}

GltfNode read_node(const JsonPlace& from, const GltfDocument& document, size_t node_count,
                   size_t skin_count) {
    GltfNode node;
    node.name = from.text("name").value_or("");
    node.local = read_transform(from);
    node.mesh = from.index("mesh", document.meshes.size());
    node.skin = from.index("skin", skin_count);
    for (const JsonPlace& child : from.array("children")) node.children.push_back(child.as_index(node_count));
    JsonPlace instancing = from.object("extensions").object("EXT_mesh_gpu_instancing");
    if (instancing.present()) {
        JsonPlace attributes = instancing.object("attributes");
        GltfInstancing many;
        many.translation = attributes.index("TRANSLATION", document.accessors.size());
        many.rotation = attributes.index("ROTATION", document.accessors.size());
        many.scale = attributes.index("SCALE", document.accessors.size());
        if (many.translation == k_gltf_none && many.rotation == k_gltf_none && many.scale == k_gltf_none)
            instancing.fault(ErrorId::value_out_of_range, "no instances", "TRANSLATION, ROTATION or SCALE");
        node.instancing = many;
    }
    node.hints = read_hints(from);
    return node;
}

// Refuses a node with two parents, and cycles, of which it tells the path.
void check_hierarchy(const GltfDocument& document, std::vector<uint32_t>& parents, JsonFault& faults) {
    parents.assign(document.nodes.size(), k_gltf_none);
    auto place = [](uint32_t node) { return "nodes[" + std::to_string(node) + "]"; };
    for (uint32_t node = 0; node < document.nodes.size(); ++node)
        for (uint32_t child : document.nodes[node].children) {
            if (parents[child] != k_gltf_none && child != node)
                faults.add(ErrorId::value_out_of_range, place(child),
                           "child of both " + place(parents[child]) + " and " + place(node),
                           "one parent a node");
            parents[child] = node;
        }
    // With one parent a node, whoever climbs longer than there are nodes runs in a circle.
    std::vector<uint8_t> reaches_root(document.nodes.size(), 0);
    for (uint32_t start = 0; start < document.nodes.size(); ++start) {
        std::vector<uint32_t> path;
        uint32_t node = start;
        while (node != k_gltf_none && !reaches_root[node] && path.size() <= document.nodes.size()) {
            path.push_back(node);
            node = parents[node];
        }
        if (node != k_gltf_none && !reaches_root[node]) {
            // Told from its first node, downwards.
            uint32_t first = node;
            for (uint32_t at = parents[node]; at != node; at = parents[at]) first = std::min(first, at);
            node = first;
            std::string circle = place(node);
            uint32_t at = parents[node];
            for (uint32_t steps = 0; at != node && steps < 16; at = parents[at], ++steps)
                circle = place(at) + " -> " + circle;
            circle = place(node) + (at == node ? " -> " : " -> ... -> ") + circle;
            faults.add(ErrorId::value_out_of_range, place(node), "the node is its own ancestor: " + circle,
                       "a hierarchy without cycles");
            return;
        }
        for (uint32_t passed : path) reaches_root[passed] = 1;
    }
}

void read_roots(const JsonPlace& root, GltfDocument& document, const std::vector<uint32_t>& parents) {
    auto scenes = root.objects("scenes");
    uint32_t chosen = root.index("scene", scenes.size());
    if (chosen == k_gltf_none) chosen = 0;
    if (scenes.empty()) {
        for (uint32_t node = 0; node < document.nodes.size(); ++node)
            if (parents[node] == k_gltf_none) document.roots.push_back(node);
        return;
    }
    for (size_t scene = 0; scene < scenes.size(); ++scene) {
        std::vector<uint8_t> seen(document.nodes.size(), 0);
        for (const JsonPlace& item : scenes[scene].array("nodes")) {
            uint32_t node = item.as_index(document.nodes.size());
            if (node >= document.nodes.size()) continue;  // the fault is noted
            if (parents[node] != k_gltf_none)
                item.fault(ErrorId::value_out_of_range, "a node with a parent", "roots only");
            if (seen[node]++)
                item.fault(ErrorId::value_out_of_range, "the same node twice", "each root once");
            if (scene == chosen) document.roots.push_back(node);
        }
    }
}

}  // namespace

Result<GltfDocument> parse_gltf(std::string_view text, const std::string& file) {
    COPPICE_TRY(nlohmann::json json, parse_json(text, file, k_depth_limit));
    JsonFault faults{file, std::nullopt};
    JsonPlace root(&json, "", faults);
    if (!json.is_object())
        return fail(ErrorId::format_unknown, file, "", "not a glTF document", "an object with \"asset\"");
    read_asset(root);

    GltfDocument document;
    document.file = file;
    auto buffers = root.objects("buffers"), views = root.objects("bufferViews"),
         accessors = root.objects("accessors"), images = root.objects("images"),
         samplers = root.objects("samplers"), textures = root.objects("textures"),
         materials = root.objects("materials"), meshes = root.objects("meshes"),
         nodes = root.objects("nodes"), skins = root.objects("skins");
    for (const JsonPlace& item : buffers) document.buffers.push_back(read_buffer(item));
    for (const JsonPlace& item : views) document.views.push_back(read_view(item, buffers.size()));
    for (const JsonPlace& item : accessors) document.accessors.push_back(read_accessor(item, views.size()));
    for (const JsonPlace& item : images) {
        GltfImage image{item.text("name").value_or(""), item.text("uri"),
                        item.index("bufferView", views.size())};
        if (image.uri.has_value() == (image.view != k_gltf_none))
            item.fault(ErrorId::value_out_of_range, "both or neither of uri and bufferView",
                       "one of the two");
        document.images.push_back(std::move(image));
    }
    for (const JsonPlace& item : textures)
        document.textures.push_back(read_texture(item, images.size(), samplers));
    for (const JsonPlace& item : materials)
        document.materials.push_back(read_material(item, textures.size()));
    for (const JsonPlace& item : meshes) {
        GltfMesh mesh{item.text("name").value_or(""), {}, read_hints(item)};
        for (const JsonPlace& primitive : item.objects("primitives"))
            mesh.primitives.push_back(read_primitive(primitive, accessors.size(), materials.size()));
        if (mesh.primitives.empty()) item.fault(ErrorId::syntax, "no primitives", "at least one");
        document.meshes.push_back(std::move(mesh));
    }
    for (const JsonPlace& item : nodes)
        document.nodes.push_back(read_node(item, document, nodes.size(), skins.size()));
    for (const JsonPlace& item : skins) {
        GltfSkin skin;
        for (const JsonPlace& joint : item.array("joints"))
            skin.joints.push_back(joint.as_index(nodes.size()));
        if (skin.joints.empty()) item.fault(ErrorId::syntax, "no joints", "at least one");
        skin.inverse_bind_matrices = item.index("inverseBindMatrices", accessors.size());
        document.skins.push_back(std::move(skin));
    }
    if (faults.first) return fail(std::move(*faults.first));
    std::vector<uint32_t> parents;
    check_hierarchy(document, parents, faults);
    read_roots(root, document, parents);
    if (faults.first) return fail(std::move(*faults.first));
    return document;
}

}  // namespace coppice
