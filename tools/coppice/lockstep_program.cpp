#include "tools/coppice/lockstep_program.h"

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace coppice {
namespace {

constexpr int k_answer_limit_ms = 120'000;  // a program may cook its plants before it is ready

ErrorId id_of_exit_code(int code) {
    return code == 2 ? ErrorId::usage : code == 3 ? ErrorId::device_missing : ErrorId::regressed;
}

}  // namespace

Result<std::unique_ptr<LockstepProgram>> LockstepProgram::start(const std::string& program,
                                                                const std::vector<std::string>& arguments) {
    std::vector<std::string> words{program, "play"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.push_back("--lockstep");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    std::unique_ptr<LockstepProgram> started(new LockstepProgram);
    started->program_ = program;
    int ends[2];
    if (::access(program.c_str(), X_OK) != 0 ||
        ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return fail(ErrorId::file_missing, program, "", "cannot be run", "name a coppice program");
    started->socket_ = ends[0];
    started->messages_ = ::memfd_create("messages", MFD_CLOEXEC);
    started->process_ = ::fork();
    if (started->process_ == 0) {
        ::dup2(ends[1], STDIN_FILENO);
        ::dup2(ends[1], STDOUT_FILENO);
        ::dup2(started->messages_, STDERR_FILENO);
        ::execv(program.c_str(), argv.data());
        ::_exit(127);
    }
    ::close(ends[1]);
    if (started->process_ < 0)
        return fail(ErrorId::limit_exceeded, program, "", "no further process can be started",
                    "end some others");
    COPPICE_TRY(const std::string line, started->read_line());
    const nlohmann::json ready = nlohmann::json::parse(line, nullptr, false);
    if (!ready.is_object() || !ready.contains("frames") || !ready["frames"].is_number_unsigned())
        return fail(ErrorId::format_unknown, program, "", "does not answer as play --lockstep does",
                    "name a coppice program");
    started->frame_count_ = ready["frames"].get<uint32_t>();
    return started;
}

LockstepProgram::~LockstepProgram() {
    if (socket_ >= 0) ::close(socket_);  // the end of its input
    if (messages_ >= 0) ::close(messages_);
    if (process_ > 0) ::waitpid(process_, nullptr, 0);
}

void LockstepProgram::show_messages() {
    char buffer[4096];
    ::lseek(messages_, 0, SEEK_SET);
    for (ssize_t count; (count = ::read(messages_, buffer, sizeof(buffer))) > 0;)
        std::fwrite(buffer, 1, size_t(count), stderr);
}

Error LockstepProgram::ended() {
    show_messages();
    ::kill(process_, SIGKILL);  // where it only hangs
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    if (WIFEXITED(status))
        return {id_of_exit_code(WEXITSTATUS(status)), program_, "",
                fmt::format("ended with exit code {}", WEXITSTATUS(status)), "see its message above"};
    return {ErrorId::regressed, program_, "", fmt::format("was ended by signal {}", WTERMSIG(status)),
            "a crash, or no answer for two minutes"};
}

Result<std::string> LockstepProgram::read_line() {
    for (;;) {
        if (const size_t end = received_.find('\n'); end != std::string::npos) {
            std::string line = received_.substr(0, end);
            received_.erase(0, end + 1);
            return line;
        }
        char buffer[4096];
        pollfd wait{socket_, POLLIN, 0};
        const ssize_t count =
            ::poll(&wait, 1, k_answer_limit_ms) > 0 ? ::read(socket_, buffer, sizeof(buffer)) : 0;
        if (count <= 0) return fail(ended());
        received_.append(buffer, size_t(count));
    }
}

Result<LockstepProgram::Drawn> LockstepProgram::draw(uint32_t frame, double slower) {
    const std::string request = fmt::format("{} {}\n", frame, slower);
    if (::send(socket_, request.data(), request.size(), MSG_NOSIGNAL) != ssize_t(request.size()))
        return fail(ended());
    COPPICE_TRY(const std::string line, read_line());
    const nlohmann::json answer = nlohmann::json::parse(line, nullptr, false);
    Drawn drawn{};
    if (!answer.is_object() || !answer.contains("ms") || !answer["ms"].is_number() ||
        !answer.contains("counts") || !answer["counts"].is_object())
        return fail(ErrorId::format_unknown, program_, "", fmt::format("answers '{}'", line),
                    "name a coppice program");
    drawn.ms = answer["ms"].get<double>();
    for (const auto& [name, count] : answer["counts"].items())
        if (count.is_number()) drawn.counts[name] = count.get<double>();
    return drawn;
}

}  // namespace coppice
