// FLIP: how different two pictures look when one is put in the place of the other, a value a pixel in [0, 1].
// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild: "FLIP: A Difference Evaluator for
// Alternating Images", 2020 (the form for pictures of limited range).
#pragma once
#include <vector>
#include "runtime/core/picture.h"
#include "runtime/core/result.h"

namespace coppice {

// Pixels a degree of a screen 0.7 m wide and 3840 pixels across, seen from 0.7 m: the paper's example.
inline constexpr float k_flip_pixels_per_degree = 67.0f;

// Pictures of one size in linear light, clamped to [0, 1], not a number to 0. pixels_per_degree: [1, 1000]. Symmetric in
// a and b. Runs on all threads; the same values on any number of them. Errors: value_out_of_range.
Result<std::vector<float>> flip_map(const FloatPicture& a, const FloatPicture& b,
                                    float pixels_per_degree = k_flip_pixels_per_degree);

}  // namespace coppice
