#include "plugins/vegetation/cook/import/gltf_uri.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace coppice {
namespace {

constexpr std::string_view k_base64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

Result<std::vector<std::byte>> decode_data_uri(std::string_view uri, const std::string& file,
                                               const std::string& place) {
    constexpr std::string_view k_mark = ";base64,";
    size_t mark = uri.substr(0, 256).find(k_mark);
    if (mark == std::string_view::npos)
        return fail(ErrorId::syntax, file, place, "a data URI that is not base64",
                    "data:MEDIA-TYPE;base64,DATA");
    std::string_view data = uri.substr(mark + k_mark.size());
    while (!data.empty() && data.back() == '=') data.remove_suffix(1);

    std::array<uint8_t, 256> digits;
    digits.fill(255);
    for (size_t i = 0; i < k_base64.size(); ++i) digits[uint8_t(k_base64[i])] = uint8_t(i);
    std::vector<std::byte> bytes;
    bytes.reserve(data.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int count = 0;
    for (size_t i = 0; i < data.size(); ++i) {
        uint8_t digit = digits[uint8_t(data[i])];
        if (digit == 255)
            return fail(ErrorId::syntax, file, place,
                        "character " + std::to_string(i) + " of the data is not base64",
                        "letters, digits, + and /");
        bits = bits << 6 | digit;
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(std::byte(bits >> count & 255u));
        }
    }
    if (count >= 6)
        return fail(ErrorId::syntax, file, place, "the base64 data ends early", "all of its characters");
    return bytes;
}

Result<std::string> resolve_uri(std::string_view uri, const std::string& base_dir, const std::string& file,
                                const std::string& place) {
    auto refuse = [&](const char* why) {
        return fail(ErrorId::value_out_of_range, file, place,
                    "the URI \"" + std::string(uri.substr(0, 100)) + "\" " + why,
                    "a file in the folder of the document or below it");
    };
    std::string path;
    for (size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            path += uri[i];
            continue;
        }
        int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
        if (high < 0 || low < 0) return refuse("has a % without two hexadecimal digits");
        path += char(high * 16 + low);
        i += 2;
    }
    if (path.empty()) return refuse("is empty");
    if (path.size() > 4096) return refuse("is too long");
    if (path.find('\0') != std::string::npos) return refuse("holds a zero");
    std::replace(path.begin(), path.end(), '\\', '/');
    if (path.front() == '/' || path.find(':') < path.find('/')) return refuse("leaves the folder");

    int depth = 0;
    for (size_t begin = 0; begin <= path.size();) {
        size_t end = std::min(path.find('/', begin), path.size());
        std::string_view step = std::string_view(path).substr(begin, end - begin);
        if (step == "..") {
            if (--depth < 0) return refuse("leaves the folder");
        } else if (!step.empty() && step != ".") {
            ++depth;
        }
        begin = end + 1;
    }
    return base_dir.empty() ? path : base_dir + "/" + path;
}

}  // namespace coppice
