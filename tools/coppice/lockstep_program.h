// Another coppice program that draws frames when it is asked to: the other side of play_lockstep.h.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>
#include <sys/types.h>
#include "runtime/core/result.h"

namespace coppice {

// When a program that says nothing is taken to hang. Before its first frame it may cook its plants for a long time; there only one
// that uses no processor time hangs, until all patience ends.
struct LockstepLimits {
    double quiet_s = 120.0;   // no answer for a frame; or, before the first, no answer and idle
    double start_s = 1800.0;  // until the first frame, in all
};

class LockstepProgram {
  public:
    // arguments: of `play`, without --lockstep. Returns when it is ready. Errors, of each function: file_missing; what the
    // program ended with by itself, 2 (usage) or 3 (device_missing); else regressed, with the signal, or how long it was
    // silent. What it wrote to standard error is then on ours.
    static Result<std::unique_ptr<LockstepProgram>> start(const std::string& program,
                                                          const std::vector<std::string>& arguments,
                                                          const LockstepLimits& limits = {});
    ~LockstepProgram();  // ends the program
    LockstepProgram(const LockstepProgram&) = delete;
    LockstepProgram& operator=(const LockstepProgram&) = delete;

    struct Drawn {
        double ms;
        std::map<std::string, double> counts;
    };
    // slower: the share of the frame's time that is waited on top.
    Result<Drawn> draw(uint32_t frame, double slower);
    uint32_t frame_count() const { return frame_count_; }

  private:
    LockstepProgram() = default;
    Result<std::string> read_line();
    Status wait_for_answer();
    void show_messages();
    Error ended();  // what to say of a program that has closed its side
    Error hung(double seconds, const char* how);
    const char* when() const { return ready_ ? "while drawing" : "before its first frame"; }

    std::string program_;
    LockstepLimits limits_;
    bool ready_ = false;  // it has announced its frames
    pid_t process_ = -1;
    int socket_ = -1;
    int messages_ = -1;  // what it says on standard error: shown where it ends before it should
    std::string received_;
    uint32_t frame_count_ = 0;
};

}  // namespace coppice
