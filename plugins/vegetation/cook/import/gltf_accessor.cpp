#include "plugins/vegetation/cook/import/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace coppice {
namespace {

constexpr uint64_t k_zeros_limit = uint64_t(1) << 22;  // numbers that a few bytes of JSON may ask for

size_t size_of(uint32_t component_type) {
    return component_type == k_gltf_byte || component_type == k_gltf_ubyte     ? 1
           : component_type == k_gltf_short || component_type == k_gltf_ushort ? 2
                                                                               : 4;
}

template <class Stored>
Stored load(const std::byte* at) {
    Stored value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

template <class Stored>
float to_float(Stored value, bool normalized) {
    if constexpr (std::is_floating_point_v<Stored>) {
        return value;
    } else {
        if (!normalized) return float(value);
        return std::max(float(double(value) / double(std::numeric_limits<Stored>::max())), -1.0f);
    }
}

// Where an array of elements lies. All of it has been checked.
struct Elements {
    std::span<const std::byte> bytes;  // from the first element on
    uint64_t count;
    size_t stride_bytes;
};

Result<Elements> locate(const GltfDocument& document, const GltfBuffers& buffers, uint32_t view,
                        uint64_t offset_bytes, uint64_t count, size_t element_bytes, size_t component_bytes,
                        const std::string& place) {
    auto bytes = buffers.view(view);
    size_t stride = document.views[view].stride_bytes ? document.views[view].stride_bytes : element_bytes;
    auto bad = [&](std::string fault, std::string remedy) {
        return fail(ErrorId::value_out_of_range, document.file, place, std::move(fault), std::move(remedy));
    };
    if (stride < element_bytes)
        return bad("elements of " + std::to_string(element_bytes) + " bytes in a byteStride of " +
                       std::to_string(stride),
                   "a stride of at least the element's size");
    if (offset_bytes % component_bytes != 0 || stride % component_bytes != 0)
        return bad("byteOffset " + std::to_string(offset_bytes) + " is not aligned",
                   "a multiple of " + std::to_string(component_bytes));
    // count <= 2^28 and stride <= 256: no overflow.
    uint64_t needed = (count - 1) * stride + element_bytes;
    if (offset_bytes > bytes.size() || needed > bytes.size() - offset_bytes)
        return bad("needs bytes " + std::to_string(offset_bytes) + " to " +
                       std::to_string(offset_bytes + needed) + " of a buffer view of " +
                       std::to_string(bytes.size()),
                   "an accessor inside its view");
    return Elements{bytes.subspan(offset_bytes), count, stride};
}

// Calls store(element, component, stored value) for all of them.
template <class Stored, class Store>
void for_each_component(const Elements& elements, uint32_t components, Store&& store) {
    for (uint64_t i = 0; i < elements.count; ++i)
        for (uint32_t c = 0; c < components; ++c)
            store(i, c, load<Stored>(elements.bytes.data() + i * elements.stride_bytes + c * sizeof(Stored)));
}

template <class Store>
void for_each_component(const Elements& elements, uint32_t component_type, uint32_t components,
                        Store&& store) {
    switch (component_type) {
        case k_gltf_byte:
            return for_each_component<int8_t>(elements, components, store);
        case k_gltf_ubyte:
            return for_each_component<uint8_t>(elements, components, store);
        case k_gltf_short:
            return for_each_component<int16_t>(elements, components, store);
        case k_gltf_ushort:
            return for_each_component<uint16_t>(elements, components, store);
        case k_gltf_uint:
            return for_each_component<uint32_t>(elements, components, store);
        default:
            return for_each_component<float>(elements, components, store);
    }
}

// Value is what comes out; convert(stored, normalised) makes it.
template <class Value, class Convert>
Result<std::vector<Value>> read_all(const GltfDocument& document, const GltfBuffers& buffers, uint32_t index,
                                    Convert&& convert) {
    const GltfAccessor& accessor = document.accessors[index];
    std::string place = "accessors[" + std::to_string(index) + "]";
    size_t component_bytes = size_of(accessor.component_type),
           element_bytes = component_bytes * accessor.components;
    if (accessor.components > 4 && component_bytes < 4)
        return fail(ErrorId::value_out_of_range, document.file, place, "a matrix of small integers",
                    "floats");

    std::vector<Value> values;
    if (accessor.view != k_gltf_none) {
        COPPICE_TRY(Elements elements, locate(document, buffers, accessor.view, accessor.offset_bytes,
                                              accessor.count, element_bytes, component_bytes, place));
        values.resize(accessor.count * accessor.components);
        for_each_component(elements, accessor.component_type, accessor.components,
                           [&](uint64_t i, uint32_t c, auto v) {
                               values[i * accessor.components + c] = convert(v, accessor.normalized);
                           });
    } else {
        // Nothing in the file backs these zeros, so their number is limited more tightly.
        if (accessor.count * accessor.components > k_zeros_limit)
            return fail(ErrorId::limit_exceeded, document.file, place,
                        std::to_string(accessor.count) + " elements without a buffer view",
                        "at most " + std::to_string(k_zeros_limit) + " numbers");
        values.resize(accessor.count * accessor.components);
    }
    if (!accessor.sparse) return values;

    const GltfSparse& sparse = *accessor.sparse;
    if (sparse.indices_type != k_gltf_ubyte && sparse.indices_type != k_gltf_ushort &&
        sparse.indices_type != k_gltf_uint)
        return fail(ErrorId::value_out_of_range, document.file, place + ".sparse.indices",
                    "componentType " + std::to_string(sparse.indices_type), "5121, 5123 or 5125");
    size_t index_bytes = size_of(sparse.indices_type);
    COPPICE_TRY(Elements where, locate(document, buffers, sparse.indices_view, sparse.indices_offset_bytes,
                                       sparse.count, index_bytes, index_bytes, place + ".sparse.indices"));
    COPPICE_TRY(Elements what,
                locate(document, buffers, sparse.values_view, sparse.values_offset_bytes, sparse.count,
                       element_bytes, component_bytes, place + ".sparse.values"));
    std::vector<uint64_t> targets(sparse.count);
    for_each_component(where, sparse.indices_type, 1,
                       [&](uint64_t i, uint32_t, auto v) { targets[i] = uint64_t(v); });
    for (uint64_t i = 0; i < targets.size(); ++i)
        if (targets[i] >= accessor.count || (i > 0 && targets[i] <= targets[i - 1]))
            return fail(ErrorId::value_out_of_range, document.file, place + ".sparse.indices",
                        "index " + std::to_string(targets[i]) + " at " + std::to_string(i),
                        "growing indices below " + std::to_string(accessor.count));
    for_each_component(what, accessor.component_type, accessor.components,
                       [&](uint64_t i, uint32_t c, auto v) {
                           values[targets[i] * accessor.components + c] = convert(v, accessor.normalized);
                       });
    return values;
}

}  // namespace

Result<std::vector<float>> read_floats(const GltfDocument& document, const GltfBuffers& buffers,
                                       uint32_t index) {
    COPPICE_TRY(auto values, read_all<float>(document, buffers, index, [](auto stored, bool normalized) {
                    return to_float(stored, normalized);
                }));
    uint32_t components = document.accessors[index].components;
    for (size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            return fail(ErrorId::value_out_of_range, document.file,
                        "accessors[" + std::to_string(index) + "]",
                        "element " + std::to_string(i / components) + " is not a finite number",
                        "finite numbers only");
    return values;
}

Result<std::vector<uint32_t>> read_indices(const GltfDocument& document, const GltfBuffers& buffers,
                                           uint32_t index) {
    const GltfAccessor& accessor = document.accessors[index];
    if (accessor.components != 1 || accessor.normalized ||
        (accessor.component_type != k_gltf_ubyte && accessor.component_type != k_gltf_ushort &&
         accessor.component_type != k_gltf_uint))
        return fail(ErrorId::value_out_of_range, document.file, "accessors[" + std::to_string(index) + "]",
                    "not of a type that indices may have", "SCALAR of componentType 5121, 5123 or 5125");
    return read_all<uint32_t>(document, buffers, index, [](auto stored, bool) { return uint32_t(stored); });
}

}  // namespace coppice
