#include "editor/document/scene_text.h"

#include "plugins/shared/json_object.h"

namespace coppice {
namespace {

constexpr size_t k_line_length = 110, k_indent = 2;

// "a": 1, "b": [1, 2]
std::string one_line(const nlohmann::ordered_json& value) {
    if (!value.is_structured()) return value.dump();
    std::string line(1, value.is_object() ? '{' : '[');
    bool first = true;
    for (const auto& [key, item] : value.items()) {
        if (!first) line += ", ";
        first = false;
        if (value.is_object()) line += nlohmann::ordered_json(key).dump() + ": ";
        line += one_line(item);
    }
    return line + (value.is_object() ? '}' : ']');
}

void print(const nlohmann::ordered_json& value, size_t indent, size_t behind, std::string& text) {
    const std::string line = one_line(value);
    const bool is_root = indent == 0;
    if (!value.is_structured() || value.empty() || (!is_root && behind + line.size() <= k_line_length)) {
        text += line;
        return;
    }
    text += value.is_object() ? '{' : '[';
    bool first = true;
    for (const auto& [key, item] : value.items()) {
        text += first ? "\n" : ",\n";
        first = false;
        const std::string name = value.is_object() ? nlohmann::ordered_json(key).dump() + ": " : "";
        text += std::string(indent + k_indent, ' ') + name;
        print(item, indent + k_indent, indent + k_indent + name.size() + 1, text);
    }
    text += "\n" + std::string(indent, ' ') + (value.is_object() ? '}' : ']');
}

}  // namespace

Result<SceneTextPtr> parse_scene_text(std::string text, const std::string& path) {
    COPPICE_TRY(const JsonDocument checked, JsonDocument::parse(text, path));
    if (!checked.root().is_object())
        return fail(ErrorId::syntax, path, "", "found " + shown(checked.root()),
                    "a scene is an object: {...}");
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(text, nullptr, false);
    return std::make_shared<const SceneText>(SceneText{std::move(text), std::move(json)});
}

SceneTextPtr print_scene_text(nlohmann::ordered_json json) {
    std::string text;
    print(json, 0, 0, text);
    return std::make_shared<const SceneText>(SceneText{text + "\n", std::move(json)});
}

}  // namespace coppice
