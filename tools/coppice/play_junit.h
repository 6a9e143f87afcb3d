// The checks of a playthrough as JUnit XML, for what shows results of tests.
#pragma once
#include <string>
#include "tools/coppice/play_record.h"

namespace coppice {

// One test case a check; inconclusive ones are skipped.
std::string junit_xml(const PlayRecord& record);

}  // namespace coppice
