#include "plugins/vegetation/cook/import/json_place.h"

#include <cmath>
#include "plugins/shared/json_depth.h"

namespace coppice {

Result<nlohmann::json> parse_json(std::string_view text, const std::string& file, int depth_limit) {
    if (const auto byte = byte_nested_deeper(text, depth_limit))
        return fail(ErrorId::limit_exceeded, file, "byte " + std::to_string(*byte),
                    "JSON nested deeper than " + std::to_string(depth_limit) + " levels", "a flatter file");
    try {
        return nlohmann::json::parse(text.begin(), text.end());
    } catch (const nlohmann::json::parse_error& thrown) {
        return fail(ErrorId::syntax, file, "byte " + std::to_string(thrown.byte),
                    "not JSON: the text does not parse", "a well-formed JSON document");
    } catch (const std::exception&) {
        return fail(ErrorId::syntax, file, "", "not JSON: the text does not parse",
                    "a well-formed JSON document");
    }
}

const nlohmann::json* JsonPlace::find(const char* key) const {
    if (!value_ || !value_->is_object()) return nullptr;
    auto found = value_->find(key);
    return found == value_->end() ? nullptr : &*found;
}

JsonPlace JsonPlace::at(const char* key) const {
    return JsonPlace(find(key), place_.empty() ? std::string(key) : place_ + "." + key, *faults_);
}

JsonPlace JsonPlace::object(const char* key) const {
    JsonPlace member = at(key);
    if (member.value_ && !member.value_->is_object()) {
        member.fault(ErrorId::value_out_of_range, "not an object", "an object in braces");
        member.value_ = nullptr;
    }
    return member;
}

JsonPlace JsonPlace::object_or_nothing(const char* key) const {
    JsonPlace member = at(key);
    if (member.value_ && !member.value_->is_object()) member.value_ = nullptr;
    return member;
}

std::vector<JsonPlace> JsonPlace::array(const char* key) const {
    std::vector<JsonPlace> items;
    JsonPlace member = at(key);
    if (!member.value_) return items;
    if (!member.value_->is_array()) {
        member.fault(ErrorId::value_out_of_range, "not an array", "an array in brackets");
        return items;
    }
    items.reserve(member.value_->size());
    for (size_t i = 0; i < member.value_->size(); ++i)
        items.emplace_back(&(*member.value_)[i], member.place_ + "[" + std::to_string(i) + "]", *faults_);
    return items;
}

std::vector<JsonPlace> JsonPlace::objects(const char* key) const {
    auto items = array(key);
    for (JsonPlace& item : items)
        if (!item.value_->is_object()) {
            item.fault(ErrorId::value_out_of_range, "not an object", "an object in braces");
            item.value_ = nullptr;
        }
    return items;
}

std::vector<std::string> JsonPlace::keys() const {
    std::vector<std::string> names;
    if (value_ && value_->is_object())
        for (auto item = value_->begin(); item != value_->end(); ++item) names.push_back(item.key());
    return names;
}

std::optional<uint64_t> JsonPlace::as_whole(uint64_t least, uint64_t most) const {
    std::optional<uint64_t> value;
    if (value_->is_number_unsigned())
        value = value_->get<uint64_t>();
    else if (value_->is_number_float()) {  // 12.0 is a whole number
        double number = value_->get<double>();
        if (number >= 0.0 && number <= 9.0e15 && number == std::floor(number)) value = uint64_t(number);
    }
    if (value && *value >= least && *value <= most) return value;
    std::string found = value_->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, 40);
    fault(ErrorId::value_out_of_range, "found " + found,
          "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return std::nullopt;
}

std::optional<float> JsonPlace::as_number() const {
    if (value_->is_number()) {
        double number = value_->get<double>();
        if (std::isfinite(float(number))) return float(number);
    }
    fault(ErrorId::value_out_of_range, "not a finite number", "a number that a float can hold");
    return std::nullopt;
}

uint64_t JsonPlace::whole(const char* key, std::optional<uint64_t> otherwise, uint64_t least,
                          uint64_t most) const {
    JsonPlace member = at(key);
    if (member.value_)
        if (auto value = member.as_whole(least, most)) return *value;
    if (!member.value_ && !otherwise && value_)
        member.fault(ErrorId::syntax, "missing", "this member is required");
    return otherwise.value_or(least);
}

float JsonPlace::number(const char* key, float otherwise) const {
    JsonPlace member = at(key);
    return member.value_ ? member.as_number().value_or(otherwise) : otherwise;
}

bool JsonPlace::flag(const char* key, bool otherwise) const {
    JsonPlace member = at(key);
    if (!member.value_) return otherwise;
    if (member.value_->is_boolean()) return member.value_->get<bool>();
    member.fault(ErrorId::value_out_of_range, "not a boolean", "true or false");
    return otherwise;
}

std::optional<std::string> JsonPlace::as_text() const {
    if (!value_) return std::nullopt;
    if (value_->is_string()) return value_->get<std::string>();
    fault(ErrorId::value_out_of_range, "not a string", "a string in quotes");
    return std::nullopt;
}

std::optional<std::string> JsonPlace::text(const char* key) const { return at(key).as_text(); }

void JsonPlace::numbers(const char* key, float* values, size_t count) const {
    if (!find(key)) return;
    auto items = array(key);
    if (items.size() != count) {
        at(key).fault(ErrorId::value_out_of_range, std::to_string(items.size()) + " numbers",
                      std::to_string(count) + " numbers");
        return;
    }
    for (size_t i = 0; i < count; ++i) values[i] = items[i].as_number().value_or(values[i]);
}

uint32_t JsonPlace::as_index(size_t count) const {
    if (!value_) return 0;
    auto value = as_whole(0, UINT32_MAX - 1);
    if (!value) return 0;
    if (*value < count) return uint32_t(*value);
    fault(ErrorId::value_out_of_range,
          "index " + std::to_string(*value) + ", but there are " + std::to_string(count),
          count == 0 ? "leave it out" : "an index from 0 to " + std::to_string(count - 1));
    return 0;
}

uint32_t JsonPlace::index(const char* key, size_t count) const {
    JsonPlace member = at(key);
    return member.value_ ? member.as_index(count) : UINT32_MAX;
}

uint32_t JsonPlace::needed_index(const char* key, size_t count) const {
    uint32_t value = index(key, count);
    if (value == UINT32_MAX && value_) at(key).fault(ErrorId::syntax, "missing", "this member is required");
    return value == UINT32_MAX ? 0 : value;
}

}  // namespace coppice
