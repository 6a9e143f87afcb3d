// What holds for every reader, whatever it reads.
#pragma once
#include <cstdio>
#include <cstdlib>
#include "runtime/core/result.h"

namespace coppice::hostile {

// Ends the process, for libFuzzer as well as for a test.
inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "does not hold: %s\n", what);
    std::abort();
}

// A clear error: what is wrong, what would be right, an exit code that says bad input.
inline void require_clear(const Error& error) {
    require(!error.fault.empty() && !error.remedy.empty(),
            "an error says what is wrong and what would be right");
    require(to_string(error).find('\n') == std::string::npos, "an error is one line");
}

template <class T>
bool accepted(const Result<T>& result) {
    if (result) return true;
    require_clear(result.error());
    require(exit_code_of(result.error().id) == 2, "an error of a file is bad input");
    return false;
}

}  // namespace coppice::hostile
