#include "tools/coppice/golden_pictures.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include "runtime/core/file.h"
#include "tools/accuracy/flip.h"
#include "tools/accuracy/metrics.h"

namespace coppice {
namespace {

double mean_of_square(const std::vector<float>& map, uint32_t width, uint32_t height, uint32_t left,
                      uint32_t top) {
    const uint32_t right = std::min(left + k_difference_square_px, width),
                   bottom = std::min(top + k_difference_square_px, height);
    double sum = 0.0;
    for (uint32_t y = top; y < bottom; ++y)
        for (uint32_t x = left; x < right; ++x) sum += double(map[size_t(y) * width + x]);
    return sum / (double(right - left) * double(bottom - top));
}

Status write_picture(const ImagesInterface* images, const std::string& path, const Picture& picture) {
    return images ? images->write(path, picture) : write_ppm(path, picture);
}

}  // namespace

Result<PictureDistance> picture_distance(const Picture& a, const Picture& b) {
    COPPICE_TRY(const std::vector<float> map, flip_map(decode_srgb(a), decode_srgb(b)));
    PictureDistance distance{0.0, {a.width, a.height, std::vector<uint8_t>(map.size() * 4, 255)}};
    for (uint32_t top = 0; top < a.height; top += k_difference_square_px)
        for (uint32_t left = 0; left < a.width; left += k_difference_square_px)
            distance.largest = std::max(distance.largest, mean_of_square(map, a.width, a.height, left, top));
    for (size_t i = 0; i < map.size(); ++i)
        std::fill_n(distance.map.rgba.begin() + long(4 * i), 3,
                    uint8_t(std::clamp(map[i], 0.0f, 1.0f) * 255.0f + 0.5f));
    return distance;
}

Status check_golden(const GoldenSettings& settings, const ImagesInterface* images, const Picture& picture,
                    const PlayPicture& kept, const std::string& out, PlayRecord& record) {
    const std::string golden_file = settings.folder + "/" + kept.file;
    if (settings.update) return write_picture(images, golden_file, picture);
    Check check{"picture " + kept.file, Verdict::failed, 1.0, settings.tolerance, "FLIP of a square", {}};
    if (!std::filesystem::exists(golden_file)) {
        check.fault = fmt::format(
            "there is no {}; keep this run's pictures with --golden-update, and look at them", golden_file);
        record.checks.push_back(std::move(check));
        return {};
    }
    COPPICE_TRY(const Picture golden, images ? images->read(golden_file) : read_ppm(golden_file));
    if (golden.width != picture.width || golden.height != picture.height) {
        check.fault = fmt::format("{} has {} x {} pixels; fly with that --headless", golden_file,
                                  golden.width, golden.height);
        record.checks.push_back(std::move(check));
        return {};
    }
    COPPICE_TRY(PictureDistance distance, picture_distance(picture, golden));
    check.value = distance.largest;
    if (distance.largest <= settings.tolerance) {
        check.verdict = Verdict::passed;
        record.checks.push_back(std::move(check));
        return {};
    }
    check.fault =
        fmt::format("a square of {0} x {0} pixels differs by {1:.3g} from {2}, at most {3:g} is taken",
                    k_difference_square_px, distance.largest, golden_file, settings.tolerance);
    record.checks.push_back(std::move(check));
    if (out.empty()) return {};
    PlayPicture difference = kept;
    difference.file.insert(difference.file.rfind('.'), "_difference");
    if (images) {
        COPPICE_TRY(difference.png, images->encode_png(distance.map));
    }
    COPPICE_CHECK(write_picture(images, out + "/" + difference.file, distance.map));
    record.differences.push_back(std::move(difference));
    return {};
}

}  // namespace coppice
