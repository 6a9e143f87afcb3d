// Vulkan's functions as volk's pointers, one set for the whole process, kept by this library under prefixed
// symbols. Include this, never <volk.h> or <vulkan/vulkan.h>.
#pragma once
#ifdef VOLK_H_
#error "volk.h was included before runtime/gpu/vulkan.h"
#endif
#include <volk_names.h>
#include <volk.h>
