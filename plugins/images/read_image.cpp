#include "plugins/images/read_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <unistd.h>
#include "runtime/core/file.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

// A few hostile kilobytes can announce any picture.
constexpr uint64_t k_pixel_limit = uint64_t(1) << 27;
constexpr uint64_t k_decoded_limit_bytes = uint64_t(1) << 29;  // what we allocate
constexpr uint64_t k_stored_limit_bytes = uint64_t(1)
                                          << 30;  // all channels as stored: what a decoder may allocate
constexpr size_t k_file_limit_bytes = size_t(1) << 30;

struct Format {
    const char* name;  // as OpenImageIO calls it
    size_t at;
    std::string_view magic;
};
using namespace std::string_view_literals;
constexpr Format k_formats[] = {
    {"png", 0, "\x89PNG\r\n\x1a\n"sv},
    {"jpeg", 0, "\xff\xd8\xff"sv},
    {"openexr", 0, "\x76\x2f\x31\x01"sv},
    {"webp", 8, "WEBP"sv},
    {"tiff", 0, "II*\0"sv},
    {"tiff", 0, "MM\0*"sv},
    {"hdr", 0, "#?"sv},
    {"bmp", 0, "BM"sv},
    {"dds", 0, "DDS "sv},
    {"gif", 0, "GIF8"sv},
    {"pnm", 0, "P6"sv},
    {"pnm", 0, "P5"sv},
    {"pnm", 0, "PF"sv},
    {"pnm", 0, "Pf"sv},
    {"jpeg2000", 4, "jP  "sv},
};

const char* find_format(std::span<const std::byte> bytes) {
    for (const Format& format : k_formats)
        if (bytes.size() >= format.at + format.magic.size() &&
            std::memcmp(bytes.data() + format.at, format.magic.data(), format.magic.size()) == 0)
            return format.name;
    return nullptr;
}

tl::unexpected<Error> corrupt(const std::string& name, std::string fault) {
    for (char& c : fault)
        if (c == '\n') c = ' ';
    return fail(ErrorId::file_corrupt, name, "",
                fault.empty() ? "the picture does not decode" : std::move(fault),
                "a whole, undamaged picture");
}

// decoded_bytes_per_pixel: of what is made of it.
Status check_header(const OIIO::ImageSpec& spec, const std::string& name, size_t decoded_bytes_per_pixel) {
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.deep)
        return corrupt(name, "the header announces no flat picture");
    bool small_sides = spec.width <= int(k_picture_side_limit) && spec.height <= int(k_picture_side_limit) &&
                       spec.depth <= 1 && spec.nchannels <= 64;
    uint64_t pixels = uint64_t(spec.width) * uint64_t(spec.height);
    uint64_t pixel_bytes = spec.pixel_bytes(true);
    // Tiles may be larger than their picture. Their sides fit 31 bits each, so the product does not overflow.
    uint64_t tile_pixels = spec.tile_width > 0 && spec.tile_height > 0
                               ? uint64_t(spec.tile_width) * uint64_t(spec.tile_height)
                               : 0;
    if (!small_sides || pixels > k_pixel_limit || pixels * pixel_bytes > k_stored_limit_bytes ||
        tile_pixels > k_stored_limit_bytes / pixel_bytes || spec.tile_depth > 1 ||
        pixels * decoded_bytes_per_pixel > k_decoded_limit_bytes)
        return fail(ErrorId::limit_exceeded, name, "header",
                    "a picture of " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                        " with " + std::to_string(spec.nchannels) + " channels",
                    "sides of at most 16384, 134 million pixels and 64 channels, and 512 MiB decoded");
    return {};
}

// Which stored channels make red, green, blue and alpha; alpha -1: none.
struct Channels {
    int red, green, blue, alpha;
};
Channels choose_channels(const OIIO::ImageSpec& spec) {
    bool grey = spec.nchannels < 3;
    int alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels ? spec.alpha_channel : -1;
    if (alpha < 0 && spec.nchannels == 2) alpha = 1;
    return grey ? Channels{0, 0, 0, alpha} : Channels{0, 1, 2, alpha};
}

// Decodes the first picture of an opened file as `count` channels of Value.
template <class Value>
Result<std::vector<Value>> decode(OIIO::ImageInput& input, const std::string& name, bool with_alpha,
                                  Value opaque) {
    OIIO::ImageSpec spec = input.spec();
    const size_t count = with_alpha ? 4 : 3;
    COPPICE_CHECK(check_header(spec, name, count * sizeof(Value)));
    const size_t pixels = size_t(spec.width) * size_t(spec.height);
    const Channels from = choose_channels(spec);
    std::vector<Value> values(pixels * count, opaque);
    // Only the channels that are needed, straight to their places.
    auto read_channels = [&](int first, int channels, size_t to) {
        return input.read_image(0, 0, first, first + channels, OIIO::BaseTypeFromC<Value>::value,
                                values.data() + to, OIIO::stride_t(count * sizeof(Value)));
    };
    const bool grey = from.green == from.red, alpha = with_alpha && from.alpha >= 0;
    const bool alpha_follows = alpha && !grey && from.alpha == 3;
    if (!read_channels(from.red,
                       grey            ? 1
                       : alpha_follows ? 4
                                       : 3,
                       0) ||
        (alpha && !alpha_follows && !read_channels(from.alpha, 1, 3)))
        return corrupt(name, input.geterror());
    if (grey)
        for (size_t i = 0; i < pixels; ++i) values[i * count + 1] = values[i * count + 2] = values[i * count];
    return values;
}

// A file that exists while its object does, for formats that OpenImageIO reads by name only.
class TemporaryFile {
  public:
    explicit TemporaryFile(std::span<const std::byte> bytes) {
        const char* folder = std::getenv("TMPDIR");
        path_ = std::string(folder && *folder ? folder : "/tmp") + "/coppice-image-XXXXXX";
        int fd = ::mkstemp(path_.data());
        if (fd < 0) {
            path_.clear();
            return;
        }
        size_t done = 0;
        while (done < bytes.size()) {
            ssize_t count = ::write(fd, bytes.data() + done, bytes.size() - done);
            if (count <= 0) break;
            done += size_t(count);
        }
        whole_ = done == bytes.size();
        ::close(fd);
    }
    ~TemporaryFile() {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    bool whole() const { return whole_; }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
    bool whole_ = false;
};

template <class Body>
auto open_and(std::span<const std::byte> bytes, const std::string& name, Body&& body)
    -> decltype(body(std::declval<OIIO::ImageInput&>())) {
    try {
        if (bytes.size() > k_file_limit_bytes)
            return fail(ErrorId::limit_exceeded, name, "",
                        "the file has " + std::to_string(bytes.size()) + " bytes",
                        "pictures of at most 1 GiB");
        const char* format = find_format(bytes);
        if (!format)
            return fail(ErrorId::format_unknown, name, "byte 0", "not a picture we know",
                        "PNG, JPEG, WebP, TIFF, EXR, HDR, BMP, DDS, GIF, JPEG 2000 or PNM");
        auto input = OIIO::ImageInput::create(format);
        if (!input)
            return fail(ErrorId::format_unknown, name, "",
                        std::string("this OpenImageIO does not read ") + format, "PNG or JPEG");
        OIIO::ImageSpec config;
        config["oiio:UnassociatedAlpha"] = 1;
        OIIO::ImageSpec spec;
        OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
        if (input->supports("ioproxy")) {
            void* proxy = &memory;
            config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
            if (!input->open(name, spec, config)) return corrupt(name, input->geterror());
            auto result = body(*input);
            input->close();
            return result;
        }
        TemporaryFile file(bytes);
        if (!file.whole())
            return fail(ErrorId::file_unreadable, name, "",
                        "no temporary file could be written to decode it from",
                        "space in the folder that TMPDIR names");
        if (!input->open(file.path(), spec, config)) return corrupt(name, input->geterror());
        auto result = body(*input);
        input->close();
        return result;
    } catch (const std::bad_alloc&) {
        return fail(ErrorId::limit_exceeded, name, "", "not enough memory to decode the picture",
                    "a smaller picture");
    } catch (const std::exception& thrown) {
        return corrupt(name, thrown.what());
    } catch (...) {
        return corrupt(name, "");
    }
}

Result<Picture> decode_picture(OIIO::ImageInput& input, const std::string& name) {
    Picture picture;
    COPPICE_TRY(picture.rgba, decode<uint8_t>(input, name, true, 255));
    picture.width = uint32_t(input.spec().width);
    picture.height = uint32_t(input.spec().height);
    return picture;
}

}  // namespace

Result<Picture> read_image_memory(std::span<const std::byte> bytes, const std::string& name) {
    return open_and(bytes, name, [&name](OIIO::ImageInput& input) { return decode_picture(input, name); });
}

Result<Picture> read_image(const std::string& path) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    return read_image_memory(file.bytes(), path);
}

Result<FloatPicture> read_float_image(const std::string& path) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    if (find_format(file.bytes()) == std::string_view("pnm")) {
        if (auto pfm = read_pfm(path)) return pfm;  // a PPM goes on below
    }
    return open_and(file.bytes(), path, [&path](OIIO::ImageInput& input) -> Result<FloatPicture> {
        FloatPicture picture;
        COPPICE_TRY(picture.rgb, decode<float>(input, path, false, 1.0f));
        picture.width = uint32_t(input.spec().width);
        picture.height = uint32_t(input.spec().height);
        return picture;
    });
}

}  // namespace coppice
