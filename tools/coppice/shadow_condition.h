// How well conditioned a shadow map's rows are.
#pragma once
#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

// The product of a matrix's and its inverse's Frobenius norms, after its rows and columns have been scaled to length
// one in turns: units of metres, texels and depth are no matter of condition.
inline double condition_of(const ShadowView& view) {
    glm::dmat4 m(glm::dvec4(view.row_x), glm::dvec4(view.row_y), glm::dvec4(view.row_z),
                 glm::dvec4(view.row_w));
    for (int round = 0; round < 60; ++round) {
        for (int i = 0; i < 4; ++i) m[i] /= std::sqrt(glm::dot(m[i], m[i]));
        m = glm::transpose(m);
    }
    const glm::dmat4 inverse = glm::inverse(m);
    double squares = 0.0, inverse_squares = 0.0;
    for (int i = 0; i < 4; ++i) {
        squares += glm::dot(m[i], m[i]);
        inverse_squares += glm::dot(inverse[i], inverse[i]);
    }
    return std::sqrt(squares * inverse_squares);
}

}  // namespace coppice
