// Fewer items, each drawn larger: leaves of a crown, billboards of a forest, plants of a meadow. Everything is said in shares:
// an item has a place u in [0, 1) in the order in which items stay, the last to go first (cook/golden_order.h for a crown; any
// sequence that is well spread for a population), and each decides alone, so that a population's near items may all stay
// while its far ones thin out.
// Source: Digital Design of Nature, 10.4 (Eq. 10.2 and 10.3); Cook et al. 2007 as ERRATA 12 tells.
#pragma once

namespace coppice {

struct DropLaw {
    float full_distance_m = 10.0f;  // up to here all stay; > 0
    float least_share = 0.01f;      // that always stays; (0, 1]
};

// lambda = k / n: of the items at a distance, falls with its square. In [least_share, 1]; 1 for a distance that is no number.
float remaining_share(float distance_m, const DropLaw& law);

// s(k), Eq. 10.3: how much longer and wider the rest is drawn. weight w in [0, 1]: 0 not at all, 1 so that the area stays. >= 1.
float weighted_growth(float share, float weight);

// Times as much area, and not less than 1, so that items strewn at random, of optical depth D (their area as seen over that
// of the ground they are strewn on), cover 1 - tolerance of what all did. Without tolerance that is 1 / lambda at any depth. A
// tolerance is what keeps dense crowns from needing leaves that reach beyond them.
float tolerant_area_growth(float share, float optical_depth, float tolerance);

// What is drawn of an item's area: 1 it stays, 0 it is gone, between them while lambda falls through a band of 2 band lambda
// about its place, so that nothing pops. Over all places the mean is lambda exactly, so the area is what it would be without
// a band. Falls never while lambda rises. place in [0, 1), band in [0, 1].
float remaining_area(float place, float share, float band);

// Contrast of the rest's shaded colours about their mean: c' = mean + contrast (c - mean). Few large items differ more than
// many small ones in a pixel.
float remaining_contrast(float share);

// From where points are fewer than the least_count items that always stay: A'_p / d'^2 <= least_count. Beyond it points stand
// for them. area_m2 of all items, at full size; least_count > 0.
float points_from_m(float area_m2, float least_count, float focal_px, float sample_distance_px);

}  // namespace coppice
