#include "plugins/terrain/read_heights.h"

#include <bit>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include "runtime/core/mapped_file.h"

static_assert(std::endian::native == std::endian::little, "raw heights are read in place");

namespace coppice {
namespace {

// Words between white space; '#' starts a comment. One white-space character ends the header.
struct Header {
    std::span<const std::byte> bytes;
    size_t at = 0;
    static bool space(std::byte b) {
        return b == std::byte(' ') || (b >= std::byte(9) && b <= std::byte(13));
    }
    std::string word() {
        for (; at < bytes.size(); ++at) {
            if (bytes[at] == std::byte('#'))
                while (at + 1 < bytes.size() && bytes[at] != std::byte('\n')) ++at;
            if (!space(bytes[at])) break;
        }
        std::string text;
        while (at < bytes.size() && !space(bytes[at]) && text.size() < 32) text += char(bytes[at++]);
        return text;
    }
    template <class Number>
    bool number(Number& value) {
        std::string text = word();
        auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
        return fault == std::errc() && end == text.data() + text.size();
    }
};

Status check_sides(const std::string& path, uint64_t columns, uint64_t rows) {
    if (columns < 2 || rows < 2)
        return fail(ErrorId::value_out_of_range, path, "header",
                    fmt::format("{} x {} heights", columns, rows), "at least 2 x 2");
    if (columns > k_terrain_side_limit || rows > k_terrain_side_limit ||
        (columns - 1) * (rows - 1) > k_terrain_cell_limit)
        return fail(ErrorId::limit_exceeded, path, "header", fmt::format("{} x {} heights", columns, rows),
                    fmt::format("at most {} cells; scale the picture down", k_terrain_cell_limit));
    return {};
}

Status check_size(const std::string& path, size_t have, uint64_t want) {
    if (have < want)
        return fail(ErrorId::file_truncated, path, fmt::format("byte {}", have), "the heights end early",
                    fmt::format("expected {} bytes of heights, found {}", want, have));
    return {};
}

HeightField sized(uint64_t columns, uint64_t rows, float cell_m) {
    HeightField field;
    field.columns = uint32_t(columns);
    field.rows = uint32_t(rows);
    field.cell_m = cell_m;
    field.heights_m.resize(size_t(columns * rows));
    return field;
}

Result<HeightField> read_pgm(const std::string& path, Header header, const HeightFileSettings& settings) {
    uint64_t columns = 0, rows = 0, largest = 0;
    if (!header.number(columns) || !header.number(rows) || !header.number(largest) || largest < 1 ||
        largest > 65535)
        return fail(ErrorId::format_unknown, path, "header", "not the header of a PGM",
                    "P5, width, height and a largest value from 1 to 65535");
    COPPICE_CHECK(check_sides(path, columns, rows));
    size_t step = largest > 255 ? 2 : 1, begin = header.at + 1;
    COPPICE_CHECK(
        check_size(path, header.bytes.size() - std::min(begin, header.bytes.size()), columns * rows * step));
    HeightField field = sized(columns, rows, settings.cell_m);
    const auto* pixels = reinterpret_cast<const uint8_t*>(header.bytes.data()) + begin;
    for (size_t i = 0; i < field.heights_m.size(); ++i) {
        uint32_t value =
            step == 2 ? uint32_t(pixels[2 * i] << 8 | pixels[2 * i + 1]) : pixels[i];  // big-endian
        if (value > largest)
            return fail(ErrorId::value_out_of_range, path, fmt::format("height {}", i),
                        fmt::format("value {}", value),
                        fmt::format("at most {}, as the header says", largest));
        field.heights_m[i] =
            settings.lowest_m + (settings.highest_m - settings.lowest_m) * (float(value) / float(largest));
    }
    return field;
}

Result<HeightField> read_pfm(const std::string& path, Header header, const HeightFileSettings& settings) {
    uint64_t columns = 0, rows = 0;
    float scale = 0.0f;
    if (!header.number(columns) || !header.number(rows) || !header.number(scale) || !(scale != 0.0f))
        return fail(ErrorId::format_unknown, path, "header", "not the header of a PFM of one channel",
                    "Pf, width, height and a scale that is not 0");
    COPPICE_CHECK(check_sides(path, columns, rows));
    size_t begin = header.at + 1;
    COPPICE_CHECK(
        check_size(path, header.bytes.size() - std::min(begin, header.bytes.size()), columns * rows * 4));
    HeightField field = sized(columns, rows, settings.cell_m);
    for (uint64_t row = 0; row < rows; ++row)
        for (uint64_t column = 0; column < columns; ++column) {
            uint32_t bits;
            std::memcpy(&bits, header.bytes.data() + begin + (row * columns + column) * 4, 4);
            if (scale > 0.0f) bits = __builtin_bswap32(bits);  // the sign says the order of the bytes
            float height = std::bit_cast<float>(bits);
            if (!(std::fabs(height) <= 1e5f))
                return fail(ErrorId::value_out_of_range, path,
                            fmt::format("height {} of row {}", column, row), fmt::format("height {}", height),
                            "metres within 100 km");
            field.heights_m[(rows - 1 - row) * columns + column] =
                height;  // rows go from the bottom in this format
        }
    return field;
}

Result<HeightField> read_raw(const std::string& path, std::span<const std::byte> bytes,
                             const HeightFileSettings& settings) {
    uint64_t columns = settings.raw_columns, rows = settings.raw_rows;
    if (columns == 0 || rows == 0) {
        columns = rows = uint64_t(std::sqrt(double(bytes.size() / 2)));
        if (columns * rows * 2 != bytes.size())
            return fail(ErrorId::value_out_of_range, path, "",
                        fmt::format("{} bytes are no square", bytes.size()),
                        "give \"samples\": [columns, rows]");
    }
    COPPICE_CHECK(check_sides(path, columns, rows));
    COPPICE_CHECK(check_size(path, bytes.size(), columns * rows * 2));
    HeightField field = sized(columns, rows, settings.cell_m);
    for (size_t i = 0; i < field.heights_m.size(); ++i) {
        uint16_t value;
        std::memcpy(&value, bytes.data() + 2 * i, 2);
        field.heights_m[i] =
            settings.lowest_m + (settings.highest_m - settings.lowest_m) * (float(value) / 65535.0f);
    }
    return field;
}

}  // namespace

Result<HeightField> read_heights(const std::string& path, const HeightFileSettings& settings) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    if (path.ends_with(".r16")) return read_raw(path, file.bytes(), settings);
    Header header{file.bytes()};
    std::string magic = header.word();
    if (magic == "P5") return read_pgm(path, header, settings);
    if (magic == "Pf") return read_pfm(path, header, settings);
    return fail(ErrorId::format_unknown, path, "byte 0", "not a height map we read",
                "a PGM that starts with P5, a PFM that starts with Pf, or a .r16");
}

}  // namespace coppice
