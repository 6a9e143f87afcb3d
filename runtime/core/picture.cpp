#include "runtime/core/picture.h"

#include <bit>
#include <cctype>
#include <cstring>
#include "runtime/core/file.h"
#include "runtime/core/mapped_file.h"

static_assert(std::endian::native == std::endian::little, "PFM and packed files are written in place");

namespace coppice {
namespace {

// Reads a header of white-space separated words; '#' starts a comment up to the end of the line.
class HeaderReader {
  public:
    explicit HeaderReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::string word() {
        while (at_ < bytes_.size()) {
            char c = current();
            if (c == '#')
                while (at_ < bytes_.size() && current() != '\n') ++at_;
            else if (std::isspace(static_cast<unsigned char>(c)))
                ++at_;
            else
                break;
        }
        std::string text;
        while (at_ < bytes_.size() && !std::isspace(static_cast<unsigned char>(current())) &&
               text.size() < 32)
            text += char(bytes_[at_++]);
        return text;
    }
    // In [1, most], or 0.
    uint32_t number(uint32_t most) {
        uint64_t value = 0;
        for (char c : word()) {
            if (c < '0' || c > '9') return 0;
            value = value * 10 + uint64_t(c - '0');
            if (value > most) return 0;
        }
        return uint32_t(value);
    }
    uint32_t side() { return number(k_picture_side_limit); }
    std::span<const std::byte> rest() {  // one white-space character ends the header
        return at_ < bytes_.size() ? bytes_.subspan(at_ + 1) : std::span<const std::byte>();
    }

  private:
    char current() const { return char(bytes_[at_]); }
    std::span<const std::byte> bytes_;
    size_t at_ = 0;
};

template <class P>
Status check_shape(const std::string& path, const P& picture, size_t values, size_t channels) {
    if (picture.width == 0 || picture.height == 0 || picture.width > k_picture_side_limit ||
        picture.height > k_picture_side_limit || values != size_t(picture.width) * picture.height * channels)
        return fail(ErrorId::value_out_of_range, path, "",
                    "a picture of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                        " with " + std::to_string(values) + " values",
                    "sides from 1 to 16384 and all their values");
    return {};
}

template <class P, class V>
Result<P> read_header(const std::string& path, const MappedFile& file, const char* magic, size_t value_bytes,
                      V P::*values, std::span<const std::byte>& rest) {
    HeaderReader header(file.bytes());
    if (header.word() != magic)
        return fail(ErrorId::format_unknown, path, "byte 0", "not a picture we read",
                    std::string("expected ") + magic);
    P picture;
    picture.width = header.side();
    picture.height = header.side();
    if (picture.width == 0 || picture.height == 0)
        return fail(ErrorId::value_out_of_range, path, "header", "bad width or height",
                    "sides from 1 to 16384");
    header.word();
    rest = header.rest();
    size_t count = size_t(picture.width) * picture.height * 3;
    if (rest.size() < count * value_bytes)
        return fail(ErrorId::file_truncated, path, "", "the picture ends early",
                    "expected " + std::to_string(count * value_bytes) + " bytes of pixels");
    (picture.*values).resize(count);
    return picture;
}

}  // namespace

Status write_ppm(const std::string& path, const Picture& picture) {
    COPPICE_CHECK(check_shape(path, picture, picture.rgba.size(), 4));
    std::string text =
        "P6\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n255\n";
    text.reserve(text.size() + picture.rgba.size());
    for (size_t i = 0; i < picture.rgba.size(); i += 4)
        text.append(reinterpret_cast<const char*>(&picture.rgba[i]), 3);
    return write_text_file(path, text);
}

Result<Picture> read_ppm(const std::string& path) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    std::span<const std::byte> rest;
    COPPICE_TRY(Picture picture, read_header<Picture>(path, file, "P6", 1, &Picture::rgba, rest));
    size_t pixels = size_t(picture.width) * picture.height;
    picture.rgba.resize(pixels * 4);
    for (size_t i = 0; i < pixels; ++i) {
        for (size_t c = 0; c < 3; ++c) picture.rgba[i * 4 + c] = uint8_t(rest[i * 3 + c]);
        picture.rgba[i * 4 + 3] = 255;
    }
    return picture;
}

Result<FloatPicture> read_pnm(const std::string& path) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    HeaderReader header(file.bytes());
    const std::string magic = header.word();
    if (magic != "P5" && magic != "P6")
        return fail(ErrorId::format_unknown, path, "byte 0", "not a picture we read", "expected P5 or P6");
    FloatPicture picture;
    picture.width = header.side();
    picture.height = header.side();
    const uint32_t largest = header.number(65535);
    if (picture.width == 0 || picture.height == 0 || largest == 0)
        return fail(ErrorId::value_out_of_range, path, "header", "bad width, height or largest value",
                    "sides from 1 to 16384 and a largest value from 1 to 65535");
    const std::span<const std::byte> rest = header.rest();
    const size_t channels = magic == "P5" ? 1 : 3, value_bytes = largest > 255 ? 2 : 1;
    const size_t count = size_t(picture.width) * picture.height * channels;
    if (rest.size() < count * value_bytes)
        return fail(ErrorId::file_truncated, path, "", "the picture ends early",
                    "expected " + std::to_string(count * value_bytes) + " bytes of pixels");
    auto value_at = [&](size_t i) {
        return value_bytes == 1 ? uint32_t(rest[i])
                                : uint32_t(rest[2 * i]) << 8 | uint32_t(rest[2 * i + 1]);  // big-endian
    };
    picture.rgb.resize(size_t(picture.width) * picture.height * 3);
    for (size_t i = 0; i < picture.rgb.size(); ++i) {
        const uint32_t value = value_at(channels == 1 ? i / 3 : i);
        if (value > largest)
            return fail(ErrorId::value_out_of_range, path, "pixel " + std::to_string(i / 3),
                        "value " + std::to_string(value),
                        "at most " + std::to_string(largest) + ", as the header says");
        picture.rgb[i] = float(value) / float(largest);
    }
    return picture;
}

Status write_pfm(const std::string& path, const FloatPicture& picture) {
    COPPICE_CHECK(check_shape(path, picture, picture.rgb.size(), 3));
    std::string text =
        "PF\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n-1.0\n";
    size_t row = size_t(picture.width) * 3;
    for (uint32_t y = picture.height; y-- > 0;)  // rows go from the bottom in this format
        text.append(reinterpret_cast<const char*>(&picture.rgb[y * row]), row * sizeof(float));
    return write_text_file(path, text);
}

Result<FloatPicture> read_pfm(const std::string& path) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    std::span<const std::byte> rest;
    COPPICE_TRY(FloatPicture picture,
                read_header<FloatPicture>(path, file, "PF", sizeof(float), &FloatPicture::rgb, rest));
    size_t row = size_t(picture.width) * 3;
    for (uint32_t y = 0; y < picture.height; ++y)
        std::memcpy(&picture.rgb[(picture.height - 1 - y) * row], rest.data() + y * row * sizeof(float),
                    row * sizeof(float));
    return picture;
}

namespace {

bool whole(const FloatPicture& picture) {
    return picture.width > 0 && picture.height > 0 && picture.width <= k_picture_side_limit &&
           picture.height <= k_picture_side_limit &&
           picture.rgb.size() == size_t(picture.width) * picture.height * 3;
}

std::string size_of(const FloatPicture& picture) {
    return std::to_string(picture.width) + "x" + std::to_string(picture.height) + " with " +
           std::to_string(picture.rgb.size()) + " values";
}

}  // namespace

Status check_same_size(const FloatPicture& a, const FloatPicture& b) {
    if (whole(a) && whole(b) && a.width == b.width && a.height == b.height) return {};
    return fail(ErrorId::value_out_of_range, "", "", "pictures of " + size_of(a) + " and " + size_of(b),
                "two pictures of one size, sides from 1 to 16384, with all their values");
}

}  // namespace coppice
