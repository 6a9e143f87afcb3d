// One of the variants the registry's test loads; what it does at unload can be read from UNLOADED_PLUGINS.
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#ifdef OLDER
#include "tests/embedding/older/plugin.h"
#else
#include "runtime/plugin/plugin.h"
#endif

#ifndef NO_ENTRY

static const int k_numbers[] = {1, 2};

#ifdef JOBS
static int g_items[1000];
static void count_items(void* items, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) ++((int*)items)[i];
}
#endif

static int load(const CoppiceHost* host) {
    if (host->size_bytes < sizeof(CoppiceHost) || host->abi != COPPICE_PLUGIN_ABI) return 1;
#if defined(GOOD)
    if (host->provide(host->context, "test.number", 1, &k_numbers[0])) return 2;
    if (host->provide(host->context, "test.number", 2, &k_numbers[1])) return 3;
    if (host->provide(host->context, "test.number", 2, &k_numbers[0]) != -1) return 4;  // taken
    if (host->provide(host->context, NULL, 1, &k_numbers[0]) != -1) return 5;
    if (host->find(host->context, "test.number", 2) != &k_numbers[1]) return 6;
    if (host->find(host->context, "test.number", 3)) return 7;
    host->log(host->context, 0, "is ready");
#elif defined(DEPENDENT)
    const int* two = host->find(host->context, "test.number", 2);
    if (!two || *two != 2) {
        host->log(host->context, 2, "needs test.number 2");
        return 8;
    }
    if (host->provide(host->context, "test.dependent", 1, &k_numbers[0])) return 9;
#elif defined(OLDER)
    if (host->size_bytes == sizeof(CoppiceHost)) return 10;  // the host is newer
    if (host->provide(host->context, "test.older", 1, &k_numbers[0])) return 11;
    if (host->find(host->context, "test.older", 1) != &k_numbers[0]) return 12;
    host->log(host->context, 1, "is old");
#elif defined(JOBS)
    (void)k_numbers;
    host->run_jobs(host->context, 1000, 16, count_items, g_items);
    for (int i = 0; i < 1000; ++i)
        if (g_items[i] != 1) return 13;
#elif defined(FAILS)
    host->provide(host->context, "test.failed", 1, &k_numbers[0]);
    host->log(host->context, 2, "has no tea");
    return 42;
#else
    (void)k_numbers;
#endif
    return 0;
}

static void unload(void) {
    const char* before = getenv("UNLOADED_PLUGINS");
    char after[256];
    snprintf(after, sizeof(after), "%s%s;", before ? before : "", VARIANT);
    setenv("UNLOADED_PLUGINS", after, 1);
}

#ifdef UNRESOLVED
int a_function_nobody_has(void);
int call_it(void);
COPPICE_PLUGIN_EXPORT int call_it(void) { return a_function_nobody_has(); }
#endif

static const CoppicePlugin k_plugin = {
#ifdef SHORT_DESCRIPTION
    .size_bytes = 12,
#else
    .size_bytes = sizeof(CoppicePlugin),
#endif
#ifdef WRONG_ABI
    .abi = COPPICE_PLUGIN_ABI + 1,
#else
    .abi = COPPICE_PLUGIN_ABI,
#endif
    .name = VARIANT,
    .version = "1",
#ifndef NO_LOAD
    .load = load,
#endif
    .unload = unload,
};

COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void);
COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) {
#ifdef NO_LOAD
    (void)load;
#endif
    return &k_plugin;
}

#else
COPPICE_PLUGIN_EXPORT int not_an_entry;
#endif
