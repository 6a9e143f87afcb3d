// The program's own definitions of these calls take the place of the C library's, also in the libraries it links.
#include "tests/faults/file_faults.h"

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <dlfcn.h>
#include <fcntl.h>
#include <map>
#include <mutex>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace coppice::faults {
namespace {

std::mutex g_mutex;
std::string g_folder, g_failed;
int64_t g_countdown = -1;
int g_error_number = 0;
std::map<int, std::string> g_files;  // by descriptor

// Sets errno where the call is to fail.
bool strikes(const char* call, const std::string& path) {
    std::lock_guard lock(g_mutex);
    if (g_folder.empty() || !path.starts_with(g_folder)) return false;
    if (g_countdown < 0 || g_countdown-- != 0) return false;
    g_failed = std::string(call) + " of " + path;
    errno = g_error_number;
    return true;
}

bool strikes(const char* call, int descriptor) {
    std::string path;
    {
        std::lock_guard lock(g_mutex);
        if (const auto found = g_files.find(descriptor); found != g_files.end()) path = found->second;
    }
    return !path.empty() && strikes(call, path);
}

void note(int descriptor, const char* path) {
    std::lock_guard lock(g_mutex);
    if (descriptor >= 0 && !g_folder.empty()) g_files[descriptor] = path;
}

void forget(int descriptor) {
    std::lock_guard lock(g_mutex);
    g_files.erase(descriptor);
}

template <class Function>
Function original(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void fail_nth_file_call(uint64_t n, int error_number, const std::string& folder) {
    std::lock_guard lock(g_mutex);
    g_folder = folder;
    g_failed.clear();
    g_error_number = error_number;
    g_countdown = int64_t(n);
}

std::string stop_failing_file_calls() {
    std::lock_guard lock(g_mutex);
    g_folder.clear();
    g_countdown = -1;
    return g_failed;
}

}  // namespace coppice::faults

using namespace coppice::faults;

#pragma GCC visibility push(default)  // for the libraries to find
extern "C" {

int open(const char* path, int flags, ...) {
    static const auto real = original<int (*)(const char*, int, ...)>("open");
    mode_t mode = 0;
    if (flags & (O_CREAT | O_TMPFILE)) {
        va_list arguments;
        va_start(arguments, flags);
        mode = mode_t(va_arg(arguments, int));
        va_end(arguments);
    }
    if (strikes("open", std::string(path))) return -1;
    const int descriptor = real(path, flags, mode);
    note(descriptor, path);
    return descriptor;
}

ssize_t pread(int descriptor, void* into, size_t bytes, off_t offset) {
    static const auto real = original<ssize_t (*)(int, void*, size_t, off_t)>("pread");
    return strikes("pread", descriptor) ? -1 : real(descriptor, into, bytes, offset);
}

ssize_t write(int descriptor, const void* from, size_t bytes) {
    static const auto real = original<ssize_t (*)(int, const void*, size_t)>("write");
    return strikes("write", descriptor) ? -1 : real(descriptor, from, bytes);
}

int fsync(int descriptor) {
    static const auto real = original<int (*)(int)>("fsync");
    return strikes("fsync", descriptor) ? -1 : real(descriptor);
}

// As Linux does it, the descriptor is gone even so.
int close(int descriptor) {
    static const auto real = original<int (*)(int)>("close");
    const bool fails = strikes("close", descriptor);
    const int error_number = errno;
    forget(descriptor);
    const int result = real(descriptor);
    if (!fails) return result;
    errno = error_number;
    return -1;
}

int fstat(int descriptor, struct stat* status) noexcept {
    static const auto real = original<int (*)(int, struct stat*)>("fstat");
    return strikes("fstat", descriptor) ? -1 : real(descriptor, status);
}

void* mmap(void* address, size_t bytes, int protection, int flags, int descriptor, off_t offset) noexcept {
    static const auto real = original<void* (*)(void*, size_t, int, int, int, off_t)>("mmap");
    if (descriptor >= 0 && strikes("mmap", descriptor)) return MAP_FAILED;
    return real(address, bytes, protection, flags, descriptor, offset);
}

int rename(const char* from, const char* to) noexcept {
    static const auto real = original<int (*)(const char*, const char*)>("rename");
    return strikes("rename", std::string(to)) ? -1 : real(from, to);
}

}  // extern "C"
#pragma GCC visibility pop
