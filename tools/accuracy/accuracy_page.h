// An accuracy record as one page for people: which method to use at which budget, the curves behind that, the
// pictures. It needs nothing but the pictures the record names, which lie beside it.
#pragma once
#include <string>
#include "tools/accuracy/accuracy_record.h"

namespace coppice {

// Samples and resting entries name methods and views the record has. All else may be missing.
std::string accuracy_page(const AccuracyRecord& record);

}  // namespace coppice
