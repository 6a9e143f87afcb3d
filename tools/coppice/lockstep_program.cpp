#include "tools/coppice/lockstep_program.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

constexpr double k_idle_share = 0.01;  // of one processor: below it, nothing is being worked on

ErrorId id_of_exit_code(int code) {
    return code == 2 ? ErrorId::usage : code == 3 ? ErrorId::device_missing : ErrorId::regressed;
}

// Processor time of all its threads; 0 where that cannot be told.
double used_s(pid_t process) {
    std::ifstream file(fmt::format("/proc/{}/stat", process));
    std::string text(std::istreambuf_iterator<char>(file), {});
    // Behind the name, which may hold anything, in brackets.
    std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
    std::string skipped;
    for (int field = 3; field < 14; ++field) fields >> skipped;
    unsigned long long user = 0, system = 0;
    fields >> user >> system;
    return double(user + system) / double(::sysconf(_SC_CLK_TCK));
}

}  // namespace

Result<std::unique_ptr<LockstepProgram>> LockstepProgram::start(const std::string& program,
                                                                const std::vector<std::string>& arguments,
                                                                const LockstepLimits& limits) {
    std::vector<std::string> words{program, "play"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.push_back("--lockstep");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    std::unique_ptr<LockstepProgram> started(new LockstepProgram);
    started->program_ = program;
    started->limits_ = limits;
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
    if (!ready.is_object() || !ready.contains("frames") || !ready["frames"].is_number_unsigned() ||
        ready["frames"] == 0 || ready["frames"] > UINT32_MAX)
        return fail(ErrorId::format_unknown, program, "", "does not answer as play --lockstep does",
                    "name a coppice program");
    started->frame_count_ = ready["frames"].get<uint32_t>();
    started->ready_ = true;
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
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    if (WIFSIGNALED(status))
        return {ErrorId::regressed, program_, "",
                fmt::format("was ended by signal {} ({}) {}", WTERMSIG(status), ::strsignal(WTERMSIG(status)),
                            when()),
                "run it alone: it crashes, or something ends it"};
    return {id_of_exit_code(WEXITSTATUS(status)), program_, "",
            fmt::format("ended with exit code {} {}", WEXITSTATUS(status), when()), "see its message above"};
}

Error LockstepProgram::hung(double seconds, const char* how) {
    show_messages();
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
    return {ErrorId::regressed, program_, "", fmt::format("{} for {:g} s {}", how, seconds, when()),
            ready_ ? "run it alone: it hangs" : "run it alone once, so that its plants are cooked"};
}

Status LockstepProgram::wait_for_answer() {
    const Stopwatch clock;
    for (double used = used_s(process_);;) {
        pollfd wait{socket_, POLLIN, 0};
        const int answers = ::poll(&wait, 1, int(limits_.quiet_s * 1e3));
        if (answers > 0) return {};
        if (answers < 0 && errno == EINTR) continue;
        if (ready_) return fail(hung(limits_.quiet_s, "gave no answer"));
        const double now_used = used_s(process_);
        if (now_used - used < k_idle_share * limits_.quiet_s)
            return fail(hung(limits_.quiet_s, "gave no answer and did nothing"));
        if (clock.ms() > limits_.start_s * 1e3) return fail(hung(limits_.start_s, "was not ready"));
        used = now_used;
    }
}

Result<std::string> LockstepProgram::read_line() {
    for (;;) {
        if (const size_t end = received_.find('\n'); end != std::string::npos) {
            std::string line = received_.substr(0, end);
            received_.erase(0, end + 1);
            return line;
        }
        char buffer[4096];
        COPPICE_CHECK(wait_for_answer());
        const ssize_t count = ::read(socket_, buffer, sizeof(buffer));
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
