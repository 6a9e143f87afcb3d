#include "plugins/vegetation/cook/oklab.h"

namespace coppice {

vec3 to_oklab(vec3 c) {
    float l = portable_pow(0.4122214708f * c.x + 0.5363325363f * c.y + 0.0514459929f * c.z, 1.0f / 3.0f);
    float m = portable_pow(0.2119034982f * c.x + 0.6806995451f * c.y + 0.1073969566f * c.z, 1.0f / 3.0f);
    float s = portable_pow(0.0883024619f * c.x + 0.2817188376f * c.y + 0.6299787005f * c.z, 1.0f / 3.0f);
    return {0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
            1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
            0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

}  // namespace coppice
