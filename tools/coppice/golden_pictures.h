// Pictures of a playthrough against pictures kept from one that was right.
#pragma once
#include <string>
#include "plugins/images/images.h"
#include "tools/coppice/play_record.h"

namespace coppice {

struct GoldenSettings {
    std::string folder;   // empty: nothing is compared
    bool update = false;  // keep the pictures there in place of comparing them
    // Of picture_distance(). What drivers round differently moves single pixels of leaves; a plant that is missing, a shadow
    // elsewhere or another colour is a square.
    double tolerance = 0.05;
};

// How far pictures are apart where they are so most: of the squares of k_difference_square_px pixels the largest mean of
// FLIP, [0, 1]. map: FLIP of each pixel as grey. Requires two pictures of one size.
inline constexpr uint32_t k_difference_square_px = 16;
struct PictureDistance {
    double largest;
    Picture map;
};
Result<PictureDistance> picture_distance(const Picture& a, const Picture& b);

// Adds a check to the record; and where it failed, the difference, written as frame_0000_difference.png into `out` unless
// that is empty. A golden that is not there or of another size is a failed check. images may be null: PPM then.
// Errors: write_failed, and the reader's for a broken golden.
Status check_golden(const GoldenSettings& settings, const ImagesInterface* images, const Picture& picture,
                    const PlayPicture& kept, const std::string& out, PlayRecord& record);

}  // namespace coppice
