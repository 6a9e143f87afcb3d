// Interface "coppice.modeller": grows a plant from a species file. Pure: same text and seed, same plant, bit
// for bit.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/result.h"

namespace coppice {

inline constexpr const char* k_modeller_interface = "coppice.modeller";
inline constexpr uint32_t k_modeller_version = 1;  // of the interface below
// Of what is grown; goes into the key of cached plants: raise it when an unchanged species file grows other
// bytes.
inline constexpr uint32_t k_growth_version = 3;

struct ModellerInterface {
    uint32_t size_bytes;
    // json: the text of a species file; file: its name, for messages only. variation: which individual (0:
    // the one the file's own seed gives). Errors: syntax, value_out_of_range, name_unknown, limit_exceeded.
    Result<PlantDescription> (*grow)(std::string_view json, const std::string& file, uint64_t variation);
};

}  // namespace coppice
