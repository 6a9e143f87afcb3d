// What can go wrong with a file, an input or a device, as a value. Every message has the four things a reader needs:
// where (file), where in it (place), what is wrong (fault), and what would be right (remedy).
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <tl/expected.hpp>

namespace coppice {

enum class ErrorId : uint16_t {
    file_missing,        // no such file, or not a regular file
    file_unreadable,     // exists, cannot be read
    file_truncated,      // ends before what it announces
    file_corrupt,        // a checksum or an internal reference is wrong
    format_unknown,      // not the kind of file that was expected, or a version we do not read
    syntax,              // JSON, CSV or glTF that does not parse
    value_out_of_range,  // a number, count or index that cannot be meant
    name_unknown,        // a species, part, method, plugin or option that does not exist
    limit_exceeded,      // correct, but larger than we take
    usage,               // a wrong command line
    write_failed,        // the old file, if any, is as it was
    device_missing,      // no Vulkan, or no device with what is required
    device_lost,         // the host may destroy and create again
    regressed,           // a check that ran and did not pass
    inconclusive,        // a comparison that noise does not allow
};

struct Error {
    ErrorId id;
    std::string file;    // as the user named it; empty if no file is concerned
    std::string place;   // "line 3", "meshes[2].primitives[0]", "byte 128"; empty for the whole file
    std::string fault;   // what is wrong, with the value found
    std::string remedy;  // what would be right, or what to do
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

// fail(...) is what a function returns: `return fail(ErrorId::syntax, path, "line 3", "found ...", "write ...");`
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorId id, std::string file, std::string place,
                                                std::string fault, std::string remedy) {
    return tl::unexpected<Error>(
        Error{id, std::move(file), std::move(place), std::move(fault), std::move(remedy)});
}
[[nodiscard]] inline tl::unexpected<Error> fail(Error error) {
    return tl::unexpected<Error>(std::move(error));
}

// "file: place: fault; remedy [id]"; empty pieces are left out. One line.
std::string to_string(const Error& error);
const char* name_of(ErrorId id);

// Exit codes of every program: 0 passed, 1 failed or regressed, 2 bad input or usage, 3 no usable device,
// 4 inconclusive.
int exit_code_of(ErrorId id);

}  // namespace coppice

// Hands an error on, or unwraps: COPPICE_TRY(auto file, MappedFile::open(path));
#define COPPICE_JOIN_(a, b) a##b
#define COPPICE_JOIN(a, b) COPPICE_JOIN_(a, b)
#define COPPICE_TRY_(temporary, declaration, expression)                  \
    auto temporary = (expression);                                        \
    if (!temporary) return ::coppice::fail(std::move(temporary.error())); \
    declaration = std::move(*temporary)
#define COPPICE_TRY(declaration, ...) \
    COPPICE_TRY_(COPPICE_JOIN(result_, __LINE__), declaration, (__VA_ARGS__))
#define COPPICE_CHECK(...)                                                                      \
    if (auto COPPICE_JOIN(status_, __LINE__) = (__VA_ARGS__); !COPPICE_JOIN(status_, __LINE__)) \
    return ::coppice::fail(std::move(COPPICE_JOIN(status_, __LINE__).error()))
