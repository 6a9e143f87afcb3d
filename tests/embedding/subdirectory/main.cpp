// Reads a packed plant, and says what is wrong with it.
#include <cstdio>
#include "plugins/vegetation/plant/plant.h"

#ifdef VK_NO_PROTOTYPES
#error "a definition for sources of coppice reached those of its host"
#endif

int main(int argc, char** argv) {
    auto plant = coppice::load_plant(argc > 1 ? argv[1] : "");
    if (!plant) std::printf("%s\n", to_string(plant.error()).c_str());
    return plant ? 0 : 2;
}
