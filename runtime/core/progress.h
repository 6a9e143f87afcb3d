// Progress of long work: one line rewritten in place on a terminal, nothing in a pipe. Safe from any thread.
#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace coppice {

class Progress {
  public:
    // what: "sampling points"; total 0: unknown.
    Progress(std::string what, uint64_t total);
    ~Progress();  // leaves a finished line on a terminal
    void advance(uint64_t steps = 1);

  private:
    void show(uint64_t done, bool last);
    std::string what_;
    uint64_t total_;
    std::atomic<uint64_t> done_{0};
    std::atomic<int64_t> next_show_ns_{0};
    std::mutex mutex_;
    bool terminal_;
};

}  // namespace coppice
