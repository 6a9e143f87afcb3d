// The C entry every plugin exports, and the only thing a host and a plugin must agree on before they talk.
// Rules: structs start with their size, new members go to the end, names of interfaces are strings with a
// version. Whoever is handed a struct reads no member beyond its size: what was built against an older header of the same
// ABI keeps working on either side. A plugin is one shared module with the function `coppice_plugin`.
#pragma once
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COPPICE_PLUGIN_ABI 1u

typedef struct CoppiceHost {
    uint32_t size_bytes;
    uint32_t abi;
    void* context;
    // Makes an interface known. The pointer stays valid until unload. 0: done; -1: the name and version are
    // taken.
    int (*provide)(void* context, const char* name, uint32_t version, const void* interface);
    // An interface of this or another plugin, or NULL.
    const void* (*find)(void* context, const char* name, uint32_t version);
    // level 0 note, 1 warning, 2 error
    void (*log)(void* context, int level, const char* line);
    // Calls body(items, first, last) for ranges of at most `grain` that cover [0, count), on the host's threads, and returns
    // when all are done. Plugins of older hosts: only where size_bytes reaches it.
    void (*run_jobs)(void* context, size_t count, size_t grain, void (*body)(void* items, size_t first, size_t last),
                     void* items);
} CoppiceHost;

typedef struct CoppicePlugin {
    uint32_t size_bytes;
    uint32_t abi;
    const char* name;
    const char* version;
    // 0: loaded. Anything else: the plugin has logged why; nothing it provided is kept.
    int (*load)(const CoppiceHost* host);
    void (*unload)(void);
} CoppicePlugin;

#if defined(__GNUC__)
#define COPPICE_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define COPPICE_PLUGIN_EXPORT __declspec(dllexport)
#endif

// Every plugin defines: COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void);
typedef const CoppicePlugin* (*CoppicePluginEntry)(void);

#ifdef __cplusplus
}
#endif
