#include "tests/tools/run_program.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

namespace {

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::string fresh_folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string folder = testing::TempDir() + "coppice_" + std::to_string(::getpid()) + "_" +
                               test->test_suite_name() + "_" + test->name();
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

ProgramResult run_coppice(const std::vector<std::string>& arguments,
                          const std::vector<std::string>& environment) {
    static int runs = 0;
    const std::string name =
        testing::TempDir() + "coppice_" + std::to_string(::getpid()) + "_" + std::to_string(runs++);
    const std::string out_path = name + ".out", err_path = name + ".err";
    const pid_t child = ::fork();
    if (child == 0) {
        const int out = ::open(out_path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        const int err = ::open(err_path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        ::dup2(out, STDOUT_FILENO);
        ::dup2(err, STDERR_FILENO);
        std::vector<char*> words{const_cast<char*>(COPPICE_PROGRAM)};
        for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
        words.push_back(nullptr);
        for (const std::string& variable : environment) ::putenv(const_cast<char*>(variable.c_str()));
        ::execv(COPPICE_PROGRAM, words.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ProgramResult result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                         read_file(out_path), read_file(err_path)};
    std::filesystem::remove(out_path);
    std::filesystem::remove(err_path);
    return result;
}
