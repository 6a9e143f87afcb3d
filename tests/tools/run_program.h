// Runs the coppice program as a user does, and keeps what it says.
#pragma once
#include <string>
#include <vector>

struct ProgramResult {
    int exit_code;  // 128 + signal where it was killed
    std::string out, err;
};

// environment: "NAME=value", on top of ours.
ProgramResult run_coppice(const std::vector<std::string>& arguments,
                          const std::vector<std::string>& environment = {});

// An empty folder of its own for the running test; removed and made again.
std::string fresh_folder();
