// How often the program asked for memory: its own operator new, which the plugins it loads use as well.
#pragma once
#include <cstdint>

namespace coppice {

// Calls of operator new since the start, of all threads.
uint64_t allocation_count();

}  // namespace coppice
