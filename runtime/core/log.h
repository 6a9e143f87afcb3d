// One line to standard error by default; a host may take all lines for itself. Safe from any thread.
#pragma once
#include <string_view>
#include <fmt/format.h>

namespace coppice {

enum class LogLevel { note, warning, error };
using LogSink = void (*)(void* context, LogLevel level, std::string_view line);

// sink == nullptr restores standard error.
void set_log_sink(LogSink sink, void* context);
void log_line(LogLevel level, std::string_view line);

template <class... Args>
void log_note(fmt::format_string<Args...> format, Args&&... args) {
    log_line(LogLevel::note, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
    log_line(LogLevel::warning, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_error(fmt::format_string<Args...> format, Args&&... args) {
    log_line(LogLevel::error, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace coppice
