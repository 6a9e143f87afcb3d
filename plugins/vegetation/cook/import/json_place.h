// A JSON value together with where it stands, so that a fault can be named. The first fault found in a
// document is kept, and reading goes on with harmless values: parsers need no branch a field, and look at the
// fault once, at the end.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

struct JsonFault {
    std::string file;
    std::optional<Error> first;
    void add(ErrorId id, std::string place, std::string fault, std::string remedy) {
        if (!first) first = Error{id, file, std::move(place), std::move(fault), std::move(remedy)};
    }
};

// Text to JSON. Refuses nesting deeper than depth_limit before the parser sees it. Errors: syntax,
// limit_exceeded.
Result<nlohmann::json> parse_json(std::string_view text, const std::string& file, int depth_limit);

class JsonPlace {
  public:
    JsonPlace(const nlohmann::json* value, std::string place, JsonFault& faults)
        : value_(value), place_(std::move(place)), faults_(&faults) {}

    bool present() const { return value_ != nullptr; }
    const std::string& place() const { return place_; }
    void fault(ErrorId id, std::string what, std::string remedy) const {
        faults_->add(id, place_, std::move(what), std::move(remedy));
    }

    // An absent member is not a fault; one of the wrong type is, and counts as absent.
    JsonPlace object(const char* key) const;
    JsonPlace object_or_nothing(const char* key) const;  // another type is no fault either
    std::vector<JsonPlace> array(const char* key) const;
    std::vector<JsonPlace> objects(const char* key) const;  // an array of objects
    bool has(const char* key) const { return find(key) != nullptr; }
    std::vector<std::string> keys() const;

    // Absent: the default; without a default: a fault.
    uint64_t whole(const char* key, std::optional<uint64_t> otherwise, uint64_t least, uint64_t most) const;
    float number(const char* key, float otherwise) const;
    bool flag(const char* key, bool otherwise) const;
    std::optional<std::string> text(const char* key) const;
    // `count` finite numbers, or what `values` holds already.
    void numbers(const char* key, float* values, size_t count) const;
    // An index below count, or UINT32_MAX where absent.
    uint32_t index(const char* key, size_t count) const;
    uint32_t needed_index(const char* key, size_t count) const;
    // This value itself as an index below count.
    uint32_t as_index(size_t count) const;
    std::optional<std::string> as_text() const;

  private:
    const nlohmann::json* find(const char* key) const;
    JsonPlace at(const char* key) const;
    std::optional<uint64_t> as_whole(uint64_t least, uint64_t most) const;
    std::optional<float> as_number() const;

    const nlohmann::json* value_;
    std::string place_;
    JsonFault* faults_;
};

}  // namespace coppice
