#include "tools/coppice/machine_load.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace coppice {
namespace {

struct ProcessorTimes {
    double busy_s = 0.0, all_s = 0.0;  // of all processors together
};

// The first line of /proc/stat: user, nice, system, idle, iowait, irq, softirq, steal, in ticks.
ProcessorTimes read_processor_times() {
    std::ifstream stream("/proc/stat");
    std::string name;
    stream >> name;
    ProcessorTimes times;
    const double tick_s = 1.0 / double(std::max(::sysconf(_SC_CLK_TCK), 1L));
    for (int column = 0; column < 8; ++column) {
        double ticks = 0.0;
        if (!(stream >> ticks)) return {};
        times.all_s += ticks * tick_s;
        if (column != 3 && column != 4) times.busy_s += ticks * tick_s;
    }
    return times;
}

double seconds(const timeval& time) { return double(time.tv_sec) + double(time.tv_usec) * 1e-6; }

double read_own_s() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

MachineLoad::MachineLoad() : own_s_(read_own_s()) {
    const ProcessorTimes times = read_processor_times();
    busy_s_ = times.busy_s;
    all_s_ = times.all_s;
}

double MachineLoad::others_share() const {
    const ProcessorTimes times = read_processor_times();
    const double all_s = times.all_s - all_s_, others_s = times.busy_s - busy_s_ - (read_own_s() - own_s_);
    return all_s > 0.0 ? std::clamp(others_s / all_s, 0.0, 1.0) : 0.0;
}

uint64_t peak_memory_bytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace coppice
