#include "plugins/vegetation/eco/density_map.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include "runtime/core/file_watcher.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

Result<bool> is_pnm(const std::string& path) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    const auto bytes = file.bytes();
    return bytes.size() >= 2 && bytes[0] == std::byte('P') &&
           (bytes[1] == std::byte('5') || bytes[1] == std::byte('6'));
}

Result<FloatPicture> read_picture(const std::string& path, const MapPictures::Find& find_images) {
    COPPICE_TRY(const bool plain, is_pnm(path));
    if (plain) return read_pnm(path);
    const ImagesInterface* images = find_images ? find_images() : nullptr;
    if (!images)
        return fail(ErrorId::format_unknown, path, "byte 0", "neither PGM nor PPM, and there is no images plugin",
                    "save it as a PGM, or install the plugin");
    return images->read_float(path);
}

}  // namespace

float DensityMap::share_at(dvec2 p) const {
    const MapPicture& map = *picture;
    const double u = (p.x - low.x) / size_m.x, v = (p.y - low.y) / size_m.y;
    if (!(u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0)) return 0.0f;
    const double x = std::clamp(u * map.width - 0.5, 0.0, double(map.width - 1));
    const double y = std::clamp(v * map.height - 0.5, 0.0, double(map.height - 1));
    const uint32_t column = uint32_t(x), row = uint32_t(y);
    const uint32_t next_column = std::min(column + 1, map.width - 1), next_row = std::min(row + 1, map.height - 1);
    const float along_x = float(x - column), along_y = float(y - row);
    auto value = [&](uint32_t c, uint32_t r) { return map.values[size_t(r) * map.width + c]; };
    const float upper = value(column, row) + (value(next_column, row) - value(column, row)) * along_x;
    const float lower =
        value(column, next_row) + (value(next_column, next_row) - value(column, next_row)) * along_x;
    return black + (white - black) * (upper + (lower - upper) * along_y);
}

Result<std::shared_ptr<const MapPicture>> MapPictures::read(const std::string& path, MapChannel channel) {
    std::error_code missing;
    Known now;
    now.written = std::filesystem::last_write_time(path, missing).time_since_epoch().count();
    now.size_bytes = missing ? 0 : std::filesystem::file_size(path, missing);
    Known& known = known_[{path, channel}];
    if (known.picture && !missing && known.written == now.written && known.size_bytes == now.size_bytes) {
        tell_file_watcher(path);
        return known.picture;
    }
    COPPICE_TRY(const FloatPicture picture, read_picture(path, find_images_));
    auto map = std::make_shared<MapPicture>();
    map->width = picture.width;
    map->height = picture.height;
    map->values.resize(size_t(picture.width) * picture.height);
    for (size_t i = 0; i < map->values.size(); ++i) {
        const float* rgb = &picture.rgb[3 * i];
        const float mean = rgb[0] == rgb[1] && rgb[1] == rgb[2] ? rgb[0] : (rgb[0] + rgb[1] + rgb[2]) / 3.0f;
        const float value = channel == MapChannel::mean ? mean : rgb[size_t(channel) - 1];
        if (!(value >= 0.0f && value <= 1.0f))
            return fail(ErrorId::value_out_of_range, path,
                        fmt::format("pixel {}, {}", i % picture.width, i / picture.width),
                        fmt::format("value {}", value), "values from 0 to 1");
        map->values[i] = value;
    }
    now.picture = std::move(map);
    known = now;
    return known.picture;
}

}  // namespace coppice
