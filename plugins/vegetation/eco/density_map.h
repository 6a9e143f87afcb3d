// A picture over a rectangle of ground: how much of a scatter's density is kept where.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/shared/region.h"
#include "runtime/core/result.h"

namespace coppice {

enum class MapChannel { mean, red, green, blue };

// One channel of a picture: as stored, in [0, 1], rows from least z.
struct MapPicture {
    uint32_t width = 0, height = 0;  // at least 1
    std::vector<float> values;
};

struct DensityMap {
    std::shared_ptr<const MapPicture> picture;
    dvec2 low{0.0}, size_m{1.0};      // the rectangle's corner of least x and z
    float black = 0.0f, white = 1.0f;  // share of the density where the picture is 0, and where it is 1

    // Bilinear between the middles of pixels; outside the rectangle nothing.
    float share_at(dvec2 p) const;
};

// Pictures that maps are made of, each read once while its file stays as it is.
class MapPictures {
  public:
    using Find = std::function<const ImagesInterface*()>;
    // find_images: asked for where a picture is neither PGM nor PPM; empty or null: there are only these.
    explicit MapPictures(Find find_images = {}) : find_images_(std::move(find_images)) {}

    // PGM and PPM are read without a library and everywhere alike; other formats by the images plugin. Errors: those of
    // reading; format_unknown without the plugin; value_out_of_range for values that are not in [0, 1], with the pixel.
    Result<std::shared_ptr<const MapPicture>> read(const std::string& path, MapChannel channel);

  private:
    struct Known {
        int64_t written = 0;
        uint64_t size_bytes = 0;
        std::shared_ptr<const MapPicture> picture;
    };
    Find find_images_;
    std::map<std::pair<std::string, MapChannel>, Known> known_;
};

}  // namespace coppice
