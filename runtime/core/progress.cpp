#include "runtime/core/progress.h"

#include <chrono>
#include <cstdio>
#include <unistd.h>

namespace coppice {
namespace {
int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
}  // namespace

Progress::Progress(std::string what, uint64_t total)
    : what_(std::move(what)), total_(total), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (terminal_) show(done_, true);
}

void Progress::advance(uint64_t steps) {
    uint64_t done = done_ += steps;
    if (!terminal_) return;
    int64_t now = now_ns(), due = next_show_ns_;
    if (now < due || !next_show_ns_.compare_exchange_strong(due, now + 100'000'000)) return;
    show(done, false);
}

void Progress::show(uint64_t done, bool last) {
    std::lock_guard lock(mutex_);
    if (total_ == 0)
        std::fprintf(stderr, "\r%s: %llu", what_.c_str(), static_cast<unsigned long long>(done));
    else
        std::fprintf(stderr, "\r%s: %3.0f %%", what_.c_str(), 100.0 * double(done) / double(total_));
    if (last) std::fputc('\n', stderr);
    std::fflush(stderr);
}

}  // namespace coppice
