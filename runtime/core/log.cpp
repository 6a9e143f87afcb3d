#include "runtime/core/log.h"

#include <cstdio>
#include <mutex>

namespace coppice {
namespace {
std::mutex g_mutex;
LogSink g_sink = nullptr;
void* g_context = nullptr;
}  // namespace

void set_log_sink(LogSink sink, void* context) {
    std::lock_guard lock(g_mutex);
    g_sink = sink;
    g_context = context;
}

void log_line(LogLevel level, std::string_view line) {
    std::lock_guard lock(g_mutex);
    if (g_sink) return g_sink(g_context, level, line);
    const char* prefix = level == LogLevel::note ? "" : level == LogLevel::warning ? "warning: " : "error: ";
    std::fprintf(stderr, "%s%.*s\n", prefix, int(line.size()), line.data());
}

}  // namespace coppice
