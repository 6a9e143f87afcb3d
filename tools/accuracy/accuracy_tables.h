// An accuracy record for programs: everything as JSON, the samples as a table.
#pragma once
#include <string>
#include <nlohmann/json.hpp>
#include "tools/accuracy/accuracy_record.h"

namespace coppice {

// Numbers that are not finite, the PSNR of equal pictures among them, are null.
nlohmann::json accuracy_json(const AccuracyRecord& record);

// A line a sample under a line of names; texts in quotes where they need them (RFC 4180), decimal points
// whatever the locale. Numbers that are not finite are empty.
std::string accuracy_csv(const AccuracyRecord& record);

}  // namespace coppice
