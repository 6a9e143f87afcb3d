// Part of every program built with the address sanitizer. Vulkan drivers and layers keep memory when they are
// unloaded. That is theirs, but a leak is known by its module's name only while the module is there: so none is
// unmapped, and those of drivers and layers are passed over. Ours are still reported.
extern "C" {

__attribute__((visibility("default"))) int dlclose(void*) { return 0; }

__attribute__((visibility("default"))) const char* __lsan_default_suppressions() {
    return "leak:libvulkan\n"
           "leak:libVkLayer\n"
           "leak:libLLVM\n"
           "leak:libnvidia\n"
           "leak:libGLX_nvidia\n"
           "leak:libdbus\n";
}
}
