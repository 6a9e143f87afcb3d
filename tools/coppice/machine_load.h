// Whether this program has the machine to itself, and how much memory it took.
#pragma once
#include <cstdint>

namespace coppice {

// From when it was made.
class MachineLoad {
  public:
    MachineLoad();
    // Share of all processors' time that other programs had, and what a hypervisor took: [0, 1]. 0 where the system does
    // not tell.
    double others_share() const;

  private:
    double busy_s_, all_s_, own_s_;
};

// Most the process ever had in memory.
uint64_t peak_memory_bytes();

}  // namespace coppice
