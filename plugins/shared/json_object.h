// Strict reading of JSON that people write: every number has a range and every key must be known. The first
// fault is kept in the document, and what is read after it gets some value in range; so a reader is the plain
// list of what may be written, and asks for the status once, before it acts.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <nlohmann/json.hpp>
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice {

class JsonDocument {
  public:
    // Errors: syntax, with line and column; limit_exceeded where it nests deeper than k_json_depth_limit.
    static Result<JsonDocument> parse(std::string_view text, const std::string& file);

    const nlohmann::json& root() const { return root_; }
    const std::string& file() const { return file_; }
    // Only the first is kept.
    void report(ErrorId id, std::string place, std::string fault, std::string remedy);
    bool sound() const { return !fault_; }
    Status status() const;

  private:
    std::string file_;
    nlohmann::json root_;
    std::optional<Error> fault_;
};

// Refers to its document, which must stay where it is.
class JsonObject {
  public:
    // place: "" for the root, else "placements[3].scatter".
    JsonObject(JsonDocument& document, const nlohmann::json& value, std::string place);

    bool has(const char* key);
    // Of the value of `key`, for messages.
    std::string place_of(const char* key) const;
    // The raw value, or nullptr.
    const nlohmann::json* find(const char* key);

    // Within [low, high]. Without `otherwise` the key is required.
    double number(const char* key, double low, double high, std::optional<double> otherwise = {});
    float real(const char* key, float low, float high, std::optional<float> otherwise = {});
    uint64_t whole(const char* key, uint64_t low, uint64_t high, std::optional<uint64_t> otherwise = {});
    bool truth(const char* key, bool otherwise);
    std::string text(const char* key, std::optional<std::string> otherwise = {});
    // Exactly `count` numbers within [low, high]; `otherwise` where the key is missing and not required.
    std::vector<double> numbers(const char* key, size_t count, double low, double high,
                                std::optional<std::vector<double>> otherwise = {});
    vec3 color(const char* key, float high, vec3 otherwise);
    // Required objects; a missing or wrong one is reported and reads as empty.
    JsonObject object(const char* key);
    std::vector<JsonObject> objects(const char* key);
    // Exactly one of the keys is present: which; else reported, and the first.
    size_t one_of(std::initializer_list<const char*> keys);

    // Reports a key that was never asked for, with the nearest of those that were.
    void close();
    void report(ErrorId id, const char* key, std::string fault, std::string remedy);
    JsonDocument& document() const { return *document_; }

  private:
    JsonDocument* document_;
    const nlohmann::json* value_;
    std::string place_;
    std::vector<std::string> asked_;
};

// The value as a message shows it: at most 40 characters.
std::string shown(const nlohmann::json& value);
// Of the same list the one with the fewest edits, "" where all differ much.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);
// "did you mean 'x'? known: a, b, c"
std::string known_names(std::string_view name, std::vector<std::string> known);

}  // namespace coppice
