#include "runtime/core/jobs.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <algorithm>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace coppice {
namespace {
JobRunner g_runner = nullptr;
void* g_host = nullptr;
std::mutex g_limit_mutex;
std::unique_ptr<tbb::global_control> g_limit;
std::atomic<unsigned> g_threads{0};
}  // namespace

void set_job_runner(JobRunner runner, void* host) {
    g_runner = runner;
    g_host = host;
}

void set_thread_limit(unsigned threads) {
    std::lock_guard lock(g_limit_mutex);
    g_threads = threads;
    g_limit.reset();
    if (threads) g_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

unsigned thread_limit() {
    unsigned threads = g_threads;
    return threads ? threads : unsigned(tbb::info::default_concurrency());
}

void run_jobs(size_t count, size_t grain, JobBody body, void* context) {
    if (count == 0) return;
    grain = std::max<size_t>(grain, 1);
    if (g_runner) return g_runner(g_host, count, grain, body, context);
    size_t ranges = (count - 1) / grain + 1;
    if (ranges == 1 || thread_limit() == 1) {
        for (size_t first = 0; first < count; first += grain) body(context, first, std::min(count, first + grain));
        return;
    }
    tbb::parallel_for(
        size_t(0), ranges,
        [&](size_t range) {
            size_t first = range * grain;
            body(context, first, std::min(count, first + grain));
        },
        tbb::simple_partitioner());
}

}  // namespace coppice
