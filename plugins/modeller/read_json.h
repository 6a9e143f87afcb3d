// Reads one object of a species file: every key has a default and a range, and a key nobody asked for is an
// error that names the nearest known one. The first fault found is kept; reading goes on with defaults, so
// callers need no checks between two keys. Takes nothing on trust: type, range and finiteness are checked
// here and nowhere else.
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice::modeller {

class JsonReader {
  public:
    // place: how messages call this object, "levels[1]"; empty for the whole file.
    JsonReader(const nlohmann::json& value, std::string file, std::string place,
               std::optional<Error>& first_error);

    void number(const char* key, float& value, float low, float high);
    void angle_deg(const char* key, float& value_rad, float low_deg, float high_deg);
    void count(const char* key, uint32_t& value, uint32_t low, uint32_t high);
    void seed(const char* key, uint64_t& value);
    void text(const char* key, std::string& value);
    // Three channels, linear, each in [0, 1].
    void color(const char* key, vec3& value);
    // Sets value to the index of the word found.
    void word(const char* key, uint32_t& value, std::initializer_list<const char*> words);
    bool has(const char* key);
    // An object, or one of an array, as a reader of its own. Absent: reads as an empty object.
    JsonReader object(const char* key);
    std::vector<JsonReader> array(const char* key, size_t least, size_t most);
    // Call after the last key: refuses those not asked for.
    void finish();
    // For faults that only this object's owner can see.
    void refuse(ErrorId id, const std::string& key, std::string fault, std::string remedy);

  private:
    const nlohmann::json* take(const char* key);
    std::string place_of(const std::string& key) const;
    const nlohmann::json* value_;
    std::string file_, place_;
    std::optional<Error>* first_error_;
    std::vector<std::string> known_;
};

// The word among `words` with the fewest single-letter changes to `word`.
std::string nearest_word(std::string_view word, const std::vector<std::string>& words);

}  // namespace coppice::modeller
