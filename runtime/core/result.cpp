#include "runtime/core/result.h"

namespace coppice {

std::string to_string(const Error& error) {
    std::string text;
    auto join = [&text](const std::string& piece, const char* separator) {
        if (piece.empty()) return;
        if (!text.empty()) text += separator;
        text += piece;
    };
    join(error.file, ": ");
    join(error.place, ": ");
    join(error.fault, ": ");
    join(error.remedy, "; ");
    text += " [";
    text += name_of(error.id);
    text += "]";
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    return text;
}

const char* name_of(ErrorId id) {
    switch (id) {
        case ErrorId::file_missing:
            return "file-missing";
        case ErrorId::file_unreadable:
            return "file-unreadable";
        case ErrorId::file_truncated:
            return "file-truncated";
        case ErrorId::file_corrupt:
            return "file-corrupt";
        case ErrorId::format_unknown:
            return "format-unknown";
        case ErrorId::syntax:
            return "syntax";
        case ErrorId::value_out_of_range:
            return "value-out-of-range";
        case ErrorId::name_unknown:
            return "name-unknown";
        case ErrorId::limit_exceeded:
            return "limit-exceeded";
        case ErrorId::usage:
            return "usage";
        case ErrorId::write_failed:
            return "write-failed";
        case ErrorId::device_missing:
            return "device-missing";
        case ErrorId::device_lost:
            return "device-lost";
        case ErrorId::regressed:
            return "regressed";
        case ErrorId::inconclusive:
            return "inconclusive";
    }
    return "unknown";
}

int exit_code_of(ErrorId id) {
    switch (id) {
        case ErrorId::device_missing:
        case ErrorId::device_lost:
            return 3;
        case ErrorId::inconclusive:
            return 4;
        case ErrorId::regressed:
        case ErrorId::write_failed:
            return 1;
        default:
            return 2;
    }
}

}  // namespace coppice
