// The text of an *.eco.json file with what it says. Never changed once made: an edit puts another in its place, and undoing
// it brings the same one back, with every space its author wrote.
#pragma once
#include <memory>
#include <string>
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

struct SceneText {
    std::string text;
    nlohmann::ordered_json json;  // keys in the file's order, known or not
};
using SceneTextPtr = std::shared_ptr<const SceneText>;

// Any text that is a JSON object. Errors: syntax, with line and column.
Result<SceneTextPtr> parse_scene_text(std::string text, const std::string& path);

// As a person would write it: what fits on a line is one. Same value, same text.
SceneTextPtr print_scene_text(nlohmann::ordered_json json);

}  // namespace coppice
