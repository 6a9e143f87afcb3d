// What a reader of a measurement must know about where it was taken.
#pragma once
#include <string>

namespace coppice {

struct Machine {
    std::string system;     // "Debian GNU/Linux 12 (bookworm), Linux 6.1.0"
    std::string processor;  // as the kernel names it
    unsigned threads;
    double memory_gib;
    std::string compiler;
    std::string build;  // "Release"
};

// What cannot be found out is empty or 0.
Machine describe_machine();

// What was typed to start this program, words with spaces in quotes.
std::string command_line();

}  // namespace coppice
