#include "plugins/vegetation/cook/keep_light.h"

namespace coppice {

vec3 LightKeeper::choose_normal(const MeasuredLeaf& a, const MeasuredLeaf& b) {
    std::array<Sums, 2> off{off_, off_};
    std::array<double, 2> square{};
    for (size_t choice = 0; choice < 2; ++choice) {
        const MeasuredLeaf& kept = choice == 0 ? a : b;
        const MeasuredLeaf& lost = choice == 0 ? b : a;
        const dvec3 n(kept.leaf.normal_plant), m(lost.leaf.normal_plant);
        const double changes[9] = {n.x - m.x,
                                   n.y - m.y,
                                   n.z - m.z,
                                   n.x * n.x - m.x * m.x,
                                   n.y * n.y - m.y * m.y,
                                   n.z * n.z - m.z * m.z,
                                   n.x * n.y - m.x * m.y,
                                   n.x * n.z - m.x * m.z,
                                   n.y * n.z - m.y * m.z};
        for (size_t k = 0; k < 9; ++k) {
            off[choice][k] += lost.area_m2 * changes[k];
            square[choice] += off[choice][k] * off[choice][k];
        }
    }
    const size_t choice = square[0] <= square[1] ? 0 : 1;
    off_ = off[choice];
    return (choice == 0 ? a : b).leaf.normal_plant;
}

}  // namespace coppice
