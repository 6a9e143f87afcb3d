#include "runtime/core/jobs.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <memory>
#include <mutex>
#include <thread>
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

#if defined(__SANITIZE_THREAD__)
// TBB as packaged is not instrumented, and the thread sanitizer would see a race in every loop. Threads of our own let
// it judge the loops' bodies.
template <class Work>
void run_ranges(size_t ranges, const Work& work) {
    std::atomic<size_t> next{0};
    auto take = [&] {
        for (size_t range; (range = next++) < ranges;) work(range);
    };
    std::thread threads[3];
    unsigned helpers = std::min<unsigned>(unsigned(std::size(threads)), thread_limit() - 1);
    for (unsigned i = 0; i < helpers; ++i) threads[i] = std::thread(take);
    take();
    for (unsigned i = 0; i < helpers; ++i) threads[i].join();
}
#else
template <class Work>
void run_ranges(size_t ranges, const Work& work) {
    tbb::parallel_for(size_t(0), ranges, work, tbb::simple_partitioner());
}
#endif
}  // namespace

void set_job_runner(JobRunner runner, void* host) {
    g_runner = runner;
    g_host = host;
}

void set_thread_limit(unsigned threads) {
    std::lock_guard lock(g_limit_mutex);
    g_threads = threads;
    g_limit.reset();
    if (threads)
        g_limit =
            std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
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
        for (size_t first = 0; first < count; first += grain)
            body(context, first, std::min(count, first + grain));
        return;
    }
    run_ranges(ranges, [&](size_t range) {
        size_t first = range * grain;
        body(context, first, std::min(count, first + grain));
    });
}

}  // namespace coppice
