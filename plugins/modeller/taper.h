// How a stem's radius falls along it. Source: Weber and Penn 1995, section 4.
#pragma once

namespace coppice::modeller {

// taper 0: cylinder; 1: cone; 2: cylinder with a rounded end; between 2 and 3: more and more a string of
// beads. along_fraction in [0, 1]. Returns the radius in metres, never negative.
float tapered_radius(float taper, float along_fraction, float base_radius_m, float length_m);

// Factor of the trunk's radius near the ground: 1 + flare at along_fraction 0.
float flare_factor(float flare, float along_fraction);

}  // namespace coppice::modeller
