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

class LockstepProgram {
  public:
    // arguments: of `play`, without --lockstep. Returns when it is ready. Errors: file_missing, and what the program ended
    // with, which is also on standard error.
    static Result<std::unique_ptr<LockstepProgram>> start(const std::string& program,
                                                          const std::vector<std::string>& arguments);
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
    void show_messages();
    Error ended();  // what to say of a program that says nothing any more

    std::string program_;
    pid_t process_ = -1;
    int socket_ = -1;
    int messages_ = -1;  // what it says on standard error: shown where it ends before it should
    std::string received_;
    uint32_t frame_count_ = 0;
};

}  // namespace coppice
