// How deep a JSON text nests, before anything is parsed: what walks a value calls itself for each level, and would run out of
// stack in a file of brackets.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace coppice {

inline constexpr int k_json_depth_limit = 64;

// Where the text first nests deeper than `levels`; texts that are no JSON are none of its business.
inline std::optional<size_t> byte_nested_deeper(std::string_view text, int levels = k_json_depth_limit) {
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '{' || c == '[') {
            if (++depth > levels) return i;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return {};
}

}  // namespace coppice
