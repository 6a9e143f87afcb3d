// Calls of the C library on files below one folder, each of which can be made to fail once.
#pragma once
#include <cstdint>
#include <string>

namespace coppice::faults {

// Of the calls that follow on files below the folder, the n-th, from 0 on, fails with that error number.
void fail_nth_file_call(uint64_t n, int error_number, const std::string& folder);
// The name of the call that failed since, with its file; empty: there were fewer.
std::string stop_failing_file_calls();

}  // namespace coppice::faults
