// Part of every program built with the address sanitizer. Vulkan drivers and layers keep memory when they are
// unloaded. That is theirs, but a leak is known by its module's name only while the module is there: so none is
// unmapped, and those of drivers and layers are passed over, as are the messages that OpenImageIO keeps of each reader that failed.
// Ours are still reported.
extern "C" {

__attribute__((visibility("default"))) int dlclose(void*) { return 0; }

__attribute__((visibility("default"))) const char* __lsan_default_suppressions() {
    return "leak:libvulkan\n"
           "leak:libVkLayer\n"
           "leak:libLLVM\n"
           "leak:libnvidia\n"
           "leak:libGLX_nvidia\n"
           "leak:libdbus\n"
           "leak:OpenImageIO*::geterror\n";
}

// The leak sanitizer finds thread-local storage of loaded libraries in two ways. One is its own hook of
// __tls_get_addr, which takes a block 16 bytes into a page for one of glibc 2.19's, reads a range from the bytes before
// it and crashes there: chance, by what was allocated before. The other is glibc's own table, which is reached anyway.
__attribute__((visibility("default"))) const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
}
