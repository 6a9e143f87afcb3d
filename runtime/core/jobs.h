// Parallel loops. Work is cut at fixed places that depend on the counts only, never on the number of threads; results
// must go to disjoint places, so they do not depend on it either. A host may bring its own threads.
#pragma once
#include <cstddef>
#include <cstdint>

namespace coppice {

// Calls body(context, first, last) for consecutive ranges of at most `grain` items covering [0, count).
using JobBody = void (*)(void* context, size_t first, size_t last);
using JobRunner = void (*)(void* host, size_t count, size_t grain, JobBody body, void* context);

// runner == nullptr restores our own threads (TBB).
void set_job_runner(JobRunner runner, void* host);
// Limits our own threads; 0: as many as the machine has. Takes effect with the next loop.
void set_thread_limit(unsigned threads);
unsigned thread_limit();

void run_jobs(size_t count, size_t grain, JobBody body, void* context);

// body(first, last)
template <class Body>
void parallel_for(size_t count, size_t grain, Body&& body) {
    run_jobs(
        count, grain,
        [](void* context, size_t first, size_t last) { (*static_cast<Body*>(context))(first, last); },
        const_cast<void*>(static_cast<const void*>(&body)));
}

}  // namespace coppice
