// What holds for every packed part that is read, whatever file it comes from.
#pragma once
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// Null where name, kind, measures, forms and gains can be used, else what is wrong. Ranges and bounds are for the reader
// of the file to check: it knows what they refer to.
const char* fault_of_measures(const PackedPart& part);

}  // namespace coppice
