#include "plugins/images/write_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cstring>
#include "runtime/core/file.h"

namespace coppice {
namespace {

std::string ending_of(const std::string& path) {
    size_t dot = path.rfind('.');
    std::string ending = dot == std::string::npos ? std::string() : path.substr(dot + 1);
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

Status check_shape(uint32_t width, uint32_t height, size_t values, size_t channels) {
    if (width == 0 || height == 0 || width > k_picture_side_limit || height > k_picture_side_limit ||
        values != size_t(width) * height * channels)
        return fail(ErrorId::value_out_of_range, "", "",
                    "a picture of " + std::to_string(width) + "x" + std::to_string(height) + " with " +
                        std::to_string(values) + " values",
                    "sides from 1 to 16384 and all their values");
    return {};
}

// rows of three channels from the top
Result<std::vector<std::byte>> encode(const char* format, uint32_t width, uint32_t height,
                                      OIIO::TypeDesc type, const void* rgb) {
    auto failed = [format](const std::string& why) {
        return fail(ErrorId::write_failed, "", "", std::string("cannot encode ") + format + ": " + why,
                    "an OpenImageIO with this format");
    };
    try {
        auto output = OIIO::ImageOutput::create(format);
        if (!output || !output->supports("ioproxy")) return failed("not supported here");
        std::vector<unsigned char> bytes;
        OIIO::Filesystem::IOVecOutput memory(bytes);
        OIIO::ImageSpec spec(int(width), int(height), 3, type);
        void* proxy = &memory;
        spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        // No time and no program in the file: the same picture gives the same bytes.
        spec["png:compressionLevel"] = 6;
        if (std::strcmp(format, "exr") == 0) spec["DateTime"] = "1970:01:01 00:00:00";  // else it takes the clock's
        if (!output->open(std::string("picture.") + format, spec)) return failed(output->geterror());
        if (!output->write_image(type, rgb)) return failed(output->geterror());
        if (!output->close()) return failed(output->geterror());
        output.reset();
        auto first = reinterpret_cast<const std::byte*>(bytes.data());
        return std::vector<std::byte>(first, first + bytes.size());
    } catch (const std::exception& thrown) {
        return failed(thrown.what());
    } catch (...) {
        return failed("unknown exception");
    }
}

Status name_the_file(Status status, const std::string& path) {
    if (!status && status.error().file.empty()) status.error().file = path;
    return status;
}

Status encode_and_write(const std::string& path, Result<std::vector<std::byte>> bytes) {
    if (!bytes) return name_the_file(fail(std::move(bytes.error())), path);
    return write_file(path, *bytes);
}

}  // namespace

Result<std::vector<std::byte>> encode_png(const Picture& picture) {
    COPPICE_CHECK(check_shape(picture.width, picture.height, picture.rgba.size(), 4));
    std::vector<uint8_t> rgb(size_t(picture.width) * picture.height * 3);
    for (size_t i = 0, n = rgb.size() / 3; i < n; ++i) std::memcpy(&rgb[i * 3], &picture.rgba[i * 4], 3);
    return encode("png", picture.width, picture.height, OIIO::TypeDesc::UINT8, rgb.data());
}

Status write_image(const std::string& path, const Picture& picture) {
    std::string ending = ending_of(path);
    if (ending == "png") return encode_and_write(path, encode_png(picture));
    if (ending == "ppm") return write_ppm(path, picture);
    return fail(ErrorId::usage, path, "", "pictures are not written as \"" + ending + "\"",
                "end the name in .png or .ppm");
}

Status write_float_image(const std::string& path, const FloatPicture& picture) {
    std::string ending = ending_of(path);
    if (ending == "pfm") return write_pfm(path, picture);
    if (ending != "exr")
        return fail(ErrorId::usage, path, "", "linear pictures are not written as \"" + ending + "\"",
                    "end the name in .exr or .pfm");
    COPPICE_CHECK(name_the_file(check_shape(picture.width, picture.height, picture.rgb.size(), 3), path));
    return encode_and_write(
        path, encode("exr", picture.width, picture.height, OIIO::TypeDesc::FLOAT, picture.rgb.data()));
}

}  // namespace coppice
