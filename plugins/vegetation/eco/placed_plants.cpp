#include "plugins/vegetation/eco/placed_plants.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <numeric>
#include <fmt/format.h>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

// "coppice placed plants": mark, version, kinds (length of the name, name, plants), plants of 18 bytes, hash of all
// before. Little-endian.
constexpr std::string_view k_mark = "CPLA";
constexpr uint32_t k_version = 1;
constexpr size_t k_plant_bytes = 18, k_hash_bytes = 8;
constexpr size_t k_kind_limit = 65536, k_name_limit = 4096;

template <std::integral T>
void put(std::string& bytes, T value) {
    for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(char(uint8_t(uint64_t(value) >> (8 * i))));
}

template <std::integral T>
T get(const char* bytes) {
    uint64_t value = 0;
    for (size_t i = 0; i < sizeof(T); ++i) value |= uint64_t(uint8_t(bytes[i])) << (8 * i);
    return T(value);
}

int32_t steps_of(double value, double steps_per_unit, double limit) {
    const double steps = std::floor(value * steps_per_unit + 0.5);
    return std::isfinite(steps) ? int32_t(std::clamp(steps, -limit, limit)) : 0;
}

constexpr int k_turn_half = 511;
constexpr float k_turn_most = 0.70710678f;  // of any part but the largest

}  // namespace

uint16_t pack_scale(float scale) {
    if (!(scale > 0.0f)) return 0;
    int exponent = 0;
    const float fraction = std::frexp(scale, &exponent);  // [0.5, 1)
    int32_t mantissa = int32_t(fraction * 4096.0f - 2048.0f + 0.5f);
    int32_t packed = (exponent + 15) * 2048 + mantissa;  // a mantissa of 2048 carries
    return uint16_t(std::clamp(packed, 0, 65535));
}

float unpack_scale(uint16_t packed) {
    return std::ldexp(1.0f + float(packed & 2047) / 2048.0f, int(packed >> 11) - 16);
}

uint32_t pack_placed_turn(PlantTurn turn) {
    const int16_t parts[4] = {turn.x, turn.y, turn.z, turn.w};
    uint32_t largest = 3;  // upright and unturned: w, for all that stand so
    for (uint32_t i = 0; i < 4; ++i)
        if (std::abs(int(parts[i])) > std::abs(int(parts[largest]))) largest = i;
    const float sign = parts[largest] < 0 ? -1.0f : 1.0f;
    uint32_t packed = largest << 30;
    uint32_t shift = 20;
    for (uint32_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const float share = std::clamp(sign * float(parts[i]) * k_turn_step / k_turn_most, -1.0f, 1.0f);
        packed |= uint32_t(int(std::floor(share * k_turn_half + 0.5f)) + k_turn_half) << shift;
        shift -= 10;
    }
    return packed;
}

PlantTurn unpack_placed_turn(uint32_t packed) {
    const uint32_t largest = packed >> 30;
    float parts[4], sum = 0.0f;
    uint32_t shift = 20;
    for (uint32_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const int step = std::min(int(packed >> shift & 1023u), 2 * k_turn_half) - k_turn_half;
        parts[i] = float(step) * (k_turn_most / float(k_turn_half));
        sum += parts[i] * parts[i];
        shift -= 10;
    }
    parts[largest] = std::sqrt(std::max(1.0f - sum, 0.0f));
    return pack_turn(parts[0], parts[1], parts[2], parts[3]);
}

PlacedPlant pack_placed(dvec3 position, float scale, PlantTurn turn, uint16_t kind, uint16_t variation) {
    constexpr double k_most = 2147483647.0, k_most_lift = 32767.0;
    return {steps_of(position.x, k_placed_steps_per_m, k_most),
            steps_of(position.z, k_placed_steps_per_m, k_most),
            kind,
            variation,
            pack_placed_turn(turn),
            pack_scale(scale),
            int16_t(steps_of(position.y, k_lift_steps_per_m, k_most_lift))};
}

Placement unpack_placed(const PlacedPlant& plant, const PlantKind& kind, double ground_y_world) {
    const PlantIndividual& individual = kind.individuals[plant.variation % kind.individuals.size()];
    const dvec2 at = ground_place(plant);
    const uint32_t seed =
        mix_bits(uint32_t(plant.x) ^ mix_bits(uint32_t(plant.z) ^ mix_bits(plant.variation + 0x51ed270bu)));
    return {dvec3(at.x, ground_y_world + plant.lift / k_lift_steps_per_m, at.y),
            unpack_scale(plant.scale) * individual.scale,
            unpack_placed_turn(plant.turn),
            {individual.model, seed}};
}

std::string write_placed(const PlacedPlants& placed) {
    std::vector<uint32_t> kind_order(placed.kinds.size());
    std::iota(kind_order.begin(), kind_order.end(), 0u);
    std::sort(kind_order.begin(), kind_order.end(),
              [&](uint32_t a, uint32_t b) { return placed.kinds[a] < placed.kinds[b]; });
    std::vector<std::vector<PlacedPlant>> of_kind(placed.kinds.size());
    for (const PlacedPlant& plant : placed.plants) of_kind[plant.kind].push_back(plant);
    std::erase_if(kind_order, [&](uint32_t kind) { return of_kind[kind].empty(); });

    std::string bytes(k_mark);
    put(bytes, k_version);
    put(bytes, uint32_t(kind_order.size()));
    for (uint32_t kind : kind_order) {
        put(bytes, uint32_t(placed.kinds[kind].size()));
        bytes += placed.kinds[kind];
        put(bytes, uint64_t(of_kind[kind].size()));
    }
    bytes.reserve(bytes.size() + placed.plants.size() * k_plant_bytes + k_hash_bytes);
    for (uint32_t kind : kind_order) {
        std::sort(of_kind[kind].begin(), of_kind[kind].end());
        for (const PlacedPlant& plant : of_kind[kind]) {
            put(bytes, plant.x);
            put(bytes, plant.z);
            put(bytes, plant.variation);
            put(bytes, plant.turn);
            put(bytes, plant.scale);
            put(bytes, plant.lift);
        }
    }
    put(bytes, hash_text(bytes));
    return bytes;
}

Result<PlacedPlants> read_placed(std::string_view bytes, const std::string& path) {
    size_t at = 0;
    auto wrong = [&](ErrorId id, std::string fault) {
        return fail(id, path, fmt::format("byte {}", at), std::move(fault),
                    "a file of placed plants as coppice-editor saves it, whole");
    };
    auto left = [&] { return bytes.size() - at; };
    const size_t head_bytes = k_mark.size() + 8;
    if (bytes.substr(0, k_mark.size()) != k_mark)
        return wrong(ErrorId::format_unknown, "no file of placed plants");
    if (bytes.size() < head_bytes + k_hash_bytes) return wrong(ErrorId::file_truncated, "ends in its head");
    at = k_mark.size();
    if (const auto version = get<uint32_t>(bytes.data() + at); version != k_version)
        return wrong(ErrorId::format_unknown, fmt::format("version {}, not {}", version, k_version));
    const auto kind_count = get<uint32_t>(bytes.data() + at + 4);
    at = head_bytes;
    if (kind_count > k_kind_limit)
        return wrong(ErrorId::limit_exceeded,
                     fmt::format("{} kinds, not up to {}", kind_count, k_kind_limit));
    PlacedPlants placed;
    std::vector<uint64_t> counts;
    uint64_t plant_count = 0;
    for (uint32_t kind = 0; kind < kind_count; ++kind) {
        if (left() < 4 + k_hash_bytes) return wrong(ErrorId::file_truncated, "ends among its kinds");
        const auto length = get<uint32_t>(bytes.data() + at);
        if (length > k_name_limit)
            return wrong(ErrorId::limit_exceeded, fmt::format("a name of {} bytes", length));
        if (left() < 4 + length + 8 + k_hash_bytes)
            return wrong(ErrorId::file_truncated, "ends among its kinds");
        placed.kinds.emplace_back(bytes.substr(at + 4, length));
        counts.push_back(get<uint64_t>(bytes.data() + at + 4 + length));
        if (counts.back() > k_plant_limit || (plant_count += counts.back()) > k_plant_limit)
            return wrong(ErrorId::limit_exceeded, fmt::format("more than {} plants", k_plant_limit));
        at += 4 + length + 8;
    }
    if (left() < plant_count * k_plant_bytes + k_hash_bytes)
        return wrong(ErrorId::file_truncated, fmt::format("ends before its {} plants do", plant_count));
    if (left() > plant_count * k_plant_bytes + k_hash_bytes)
        return wrong(ErrorId::file_corrupt, "goes on behind its plants");
    const size_t hashed = bytes.size() - k_hash_bytes;
    if (get<uint64_t>(bytes.data() + hashed) != hash_text(bytes.substr(0, hashed)))
        return wrong(ErrorId::file_corrupt, "its checksum is not that of its bytes");
    placed.plants.reserve(plant_count);
    for (uint32_t kind = 0; kind < kind_count; ++kind)
        for (uint64_t i = 0; i < counts[kind]; ++i, at += k_plant_bytes) {
            const char* from = bytes.data() + at;
            placed.plants.push_back({get<int32_t>(from), get<int32_t>(from + 4), uint16_t(kind),
                                     get<uint16_t>(from + 8), get<uint32_t>(from + 10),
                                     get<uint16_t>(from + 14), get<int16_t>(from + 16)});
        }
    return placed;
}

}  // namespace coppice
