// Vulkan's calls, each of which can be made to fail once, and a count of the objects that they have made and not destroyed yet.
#pragma once
#include <cstdint>
#include <string>
#include "runtime/gpu/vulkan_types.h"

namespace coppice::faults {

// Before the first device of the process is made.
void watch_vulkan();

// Of the calls that follow the n-th, from 0 on, fails with that result, if it is one that can; the rest do what they do.
void fail_nth(uint64_t n, VkResult result);
// The name of the call that failed since; empty: there were fewer.
std::string stop_failing();

// Instances, devices, buffers, memory and so on that exist.
int64_t live_objects();

}  // namespace coppice::faults
