#include "plugins/terrain/ground_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include "runtime/core/hash.h"
#include "runtime/core/open_file.h"

static_assert(std::endian::native == std::endian::little, "packed grounds are little-endian");

namespace coppice {
namespace {

constexpr char k_magic[4] = {'C', 'G', 'N', 'D'};
constexpr float k_farthest_height_m = 1e5f;  // read_heights.cpp
constexpr const char* k_remedy = "packed grounds are a cache: populate the scene again";

struct GroundHead {
    char magic[4];
    uint32_t version;
    uint64_t checksum;  // of the file, with this field zero
    uint32_t columns, rows;
    float cell_m;
    uint32_t periodic;  // 0 or 1
    uint32_t word_count;
    uint32_t reserved[7];  // 0

    uint64_t height_count() const { return uint64_t(columns) * rows; }
    uint64_t file_bytes() const { return sizeof(GroundHead) + 4 * (height_count() + word_count); }
};
static_assert(sizeof(GroundHead) == 64);

uint64_t checksum_of(GroundHead head, std::span<const float> heights_m, std::span<const uint32_t> words) {
    head.checksum = 0;
    return hash_span(words, hash_span(heights_m, hash_bytes(&head, sizeof head)));
}

Status check_head(const GroundHead& head, const OpenFile& file) {
    auto wrong = [&file](ErrorId id, std::string place, std::string fault, std::string remedy) {
        return fail(id, file.path(), std::move(place), std::move(fault), std::move(remedy));
    };
    if (std::memcmp(head.magic, k_magic, sizeof k_magic) != 0)
        return wrong(ErrorId::format_unknown, "byte 0", "not a packed ground", "name a .ground file");
    if (file.size_bytes() < sizeof head)
        return wrong(ErrorId::file_truncated, "head", "it ends inside its head", k_remedy);
    if (head.version != k_ground_version)
        return wrong(
            ErrorId::format_unknown, "byte 4", fmt::format("version {}", head.version),
            fmt::format("this program reads version {}; populate the scene again", k_ground_version));
    if (head.columns < 2 || head.rows < 2 || head.columns > k_terrain_side_limit ||
        head.rows > k_terrain_side_limit ||
        uint64_t(head.columns - 1) * (head.rows - 1) > k_terrain_cell_limit)
        return wrong(ErrorId::limit_exceeded, "head", fmt::format("{} x {} heights", head.columns, head.rows),
                     fmt::format("2 x 2 to {} cells; {}", k_terrain_cell_limit, k_remedy));
    if (file.size_bytes() != head.file_bytes())
        return wrong(
            file.size_bytes() < head.file_bytes() ? ErrorId::file_truncated : ErrorId::file_corrupt, "head",
            fmt::format("it has {} bytes and announces {}", file.size_bytes(), head.file_bytes()), k_remedy);
    return {};
}

// False for NaN.
bool is_within_reach(float height_m) { return std::fabs(height_m) <= k_farthest_height_m; }

}  // namespace

PackedTerrain pack_ground(const HeightField& field, std::span<const uint32_t> words) {
    GroundHead head{};
    std::memcpy(head.magic, k_magic, sizeof k_magic);
    head.version = k_ground_version;
    head.columns = field.columns;
    head.rows = field.rows;
    head.cell_m = field.cell_m;
    head.periodic = field.periodic;
    head.word_count = uint32_t(words.size());
    head.checksum = checksum_of(head, field.heights_m, words);
    PackedTerrain packed;
    packed.content_hash = head.checksum;
    packed.bytes.resize(head.file_bytes());
    std::byte* to = packed.bytes.data();
    auto append = [&to](const void* from, size_t size_bytes) {
        if (size_bytes == 0) return;  // from may be null then
        std::memcpy(to, from, size_bytes);
        to += size_bytes;
    };
    append(&head, sizeof head);
    append(field.heights_m.data(), field.heights_m.size() * sizeof(float));
    append(words.data(), words.size_bytes());
    return packed;
}

Result<PackedGround> read_ground(const std::string& path) {
    COPPICE_TRY(const OpenFile file, OpenFile::open(path));
    GroundHead head{};
    const size_t present = size_t(std::min<uint64_t>(file.size_bytes(), sizeof head));
    COPPICE_CHECK(file.read(0, std::as_writable_bytes(std::span(&head, 1)).first(present)));
    COPPICE_CHECK(check_head(head, file));
    PackedGround ground;
    ground.content_hash = head.checksum;
    HeightField& field = ground.field;
    field.columns = head.columns;
    field.rows = head.rows;
    field.cell_m = head.cell_m;
    field.periodic = head.periodic != 0;
    field.heights_m.resize(head.height_count());
    ground.words.resize(head.word_count);
    COPPICE_CHECK(file.read(sizeof head, std::as_writable_bytes(std::span(field.heights_m))));
    COPPICE_CHECK(
        file.read(sizeof head + 4 * head.height_count(), std::as_writable_bytes(std::span(ground.words))));
    if (checksum_of(head, field.heights_m, ground.words) != head.checksum)
        return fail(ErrorId::file_corrupt, path, "", "its checksum is wrong", k_remedy);
    if (!(head.cell_m > 0.0f && head.cell_m <= k_farthest_height_m) || head.periodic > 1 ||
        !std::all_of(field.heights_m.begin(), field.heights_m.end(), is_within_reach))
        return fail(ErrorId::value_out_of_range, path, "heights", "cells or heights that no ground has",
                    k_remedy);
    ground.mesh = build_patches(field);
    if (ground.words.size() != ground.mesh.word_count)
        return fail(ErrorId::value_out_of_range, path, "surface words",
                    fmt::format("{} of them", ground.words.size()),
                    fmt::format("{} for {} x {} heights; {}", ground.mesh.word_count, field.columns,
                                field.rows, k_remedy));
    return ground;
}

}  // namespace coppice
