// Vulkan's functions as volk's pointers, one set for the whole process, kept by this library under prefixed
// symbols. For sources that call Vulkan: include this, never <volk.h> or <vulkan/vulkan.h>, and never in a header that hosts see.
#pragma once
#ifdef VOLK_H_
#error "volk.h was included before runtime/gpu/vulkan.h"
#endif
#include <volk_names.h>
#include <volk.h>
