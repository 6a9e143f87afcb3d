// The files the running program consists of: itself, its libraries, the plugins loaded so far.
#pragma once
#include <string>
#include <vector>

namespace coppice {

// Where the dynamic linker found them, sorted; the program is among them. What belongs to the system is left
// out: glibc and its parts, which must fit each other, and the Vulkan loader, which must fit the driver.
std::vector<std::string> loaded_objects();

// libstdc++ and libgcc_s, which drivers need as well as we do.
bool is_compiler_runtime(const std::string& path);

}  // namespace coppice
