// What the bench is to reach, from what it measured.
#pragma once
#include <vector>
#include "tools/accuracy/accuracy_record.h"

namespace coppice {

// Against the reference with shadows. A value that cannot be had from the record is left out.
std::vector<Figure> accuracy_figures(const AccuracyRecord& record);

}  // namespace coppice
