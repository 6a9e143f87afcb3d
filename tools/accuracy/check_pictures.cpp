#include "tools/accuracy/check_pictures.h"

#include <cmath>
#include <string>

namespace coppice {

Status check_finite(std::span<const float> values, const char* what) {
    for (size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            return fail(ErrorId::value_out_of_range, "", std::string(what) + ", value " + std::to_string(i),
                        "a value that is not finite", "finite values");
    return {};
}

}  // namespace coppice
