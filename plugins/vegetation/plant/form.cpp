#include "plugins/vegetation/plant/plant.h"

namespace coppice {

float DirectionForm::evaluate(vec3 d) const {
    float square = m[0] * d.x * d.x + m[1] * d.y * d.y + m[2] * d.z * d.z +
                   2.0f * (m[3] * d.x * d.y + m[4] * d.x * d.z + m[5] * d.y * d.z);
    return square > 0.0f ? std::sqrt(square) : 0.0f;
}

}  // namespace coppice
