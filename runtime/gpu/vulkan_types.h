// Vulkan's types for headers that hosts include: no function of theirs is renamed and none of ours is declared. A host includes
// its own way to Vulkan (prototypes, volk or another loader) before any header of this project.
#pragma once
#include <vulkan/vulkan_core.h>
