// Accessors as plain arrays: any component type, interleaved, normalised, sparse. Every byte read is checked
// to lie in its view first, without overflow.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/gltf_buffers.h"
#include "plugins/vegetation/cook/import/gltf_document.h"

namespace coppice {

// count x components floats. Integers become numbers: in [0, 1] or [-1, 1] where normalised.
// Errors: value_out_of_range (bounds, NaN and infinities, sparse indices), with the accessor's place.
Result<std::vector<float>> read_floats(const GltfDocument& document, const GltfBuffers& buffers,
                                       uint32_t accessor);
// Unsigned integers of a scalar accessor.
Result<std::vector<uint32_t>> read_indices(const GltfDocument& document, const GltfBuffers& buffers,
                                           uint32_t accessor);

}  // namespace coppice
