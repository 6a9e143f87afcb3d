#include "plugins/shared/json_object.h"

#include <algorithm>
#include <fmt/format.h>
#include "plugins/shared/json_depth.h"

namespace coppice {
namespace {

const nlohmann::json k_empty_object = nlohmann::json::object();

std::string range_text(double low, double high) {
    return fmt::format("a number from {:g} to {:g}", low, high);
}

bool within(const nlohmann::json& value, double low, double high) {
    if (!value.is_number()) return false;
    double number = value.get<double>();
    return number >= low && number <= high;  // false for NaN
}

}  // namespace

std::string shown(const nlohmann::json& value) {
    std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return text.size() <= 40 ? text : text.substr(0, 37) + "...";
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
    std::string best;
    size_t best_edits = std::max<size_t>(2, name.size() / 2) + 1;
    std::vector<size_t> row;
    for (const std::string& candidate : known) {
        if (name.size() > 64 || candidate.size() > 64) continue;
        row.resize(candidate.size() + 1);
        for (size_t j = 0; j <= candidate.size(); ++j) row[j] = j;
        for (size_t i = 1; i <= name.size(); ++i) {
            size_t diagonal = row[0];
            row[0] = i;
            for (size_t j = 1; j <= candidate.size(); ++j) {
                size_t replaced = diagonal + (name[i - 1] != candidate[j - 1]);
                diagonal = row[j];
                row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
            }
        }
        if (row.back() < best_edits) {
            best_edits = row.back();
            best = candidate;
        }
    }
    return best;
}

std::string known_names(std::string_view name, std::vector<std::string> known) {
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    std::string nearest = nearest_name(name, known);
    std::string list = fmt::format("{}", fmt::join(known, ", "));
    return nearest.empty() ? "known: " + list : fmt::format("did you mean '{}'? known: {}", nearest, list);
}

Result<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& file) {
    JsonDocument document;
    document.file_ = file;
    if (const auto byte = byte_nested_deeper(text))
        return fail(ErrorId::limit_exceeded, file, fmt::format("byte {}", *byte),
                    fmt::format("JSON nested deeper than {} levels", k_json_depth_limit), "a flatter file");
    try {
        document.root_ = nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        size_t at = std::min(error.byte > 0 ? size_t(error.byte) - 1 : 0, text.size());
        size_t line = 1 + size_t(std::count(text.begin(), text.begin() + ptrdiff_t(at), '\n'));
        size_t line_begin = text.rfind('\n', at > 0 ? at - 1 : 0);
        if (at == 0 || line_begin == std::string_view::npos) line_begin = size_t(-1);
        std::string fault =
            error.what();  // "[json.exception...] parse error at line 1, column 2: what is wrong"
        if (size_t colon = fault.find(": "); colon != std::string::npos) fault = fault.substr(colon + 2);
        return fail(ErrorId::syntax, file, fmt::format("line {}, column {}", line, at - line_begin), fault,
                    "write valid JSON");
    } catch (const nlohmann::json::exception& error) {
        return fail(ErrorId::syntax, file, "", error.what(),
                    "write valid JSON with numbers a double can hold");
    }
    return document;
}

void JsonDocument::report(ErrorId id, std::string place, std::string fault, std::string remedy) {
    if (!fault_) fault_ = Error{id, file_, std::move(place), std::move(fault), std::move(remedy)};
}

Status JsonDocument::status() const {
    if (fault_) return fail(*fault_);
    return {};
}

JsonObject::JsonObject(JsonDocument& document, const nlohmann::json& value, std::string place)
    : document_(&document), value_(&value), place_(std::move(place)) {
    if (!value.is_object()) {
        document_->report(ErrorId::syntax, place_, "found " + shown(value), "write an object: { ... }");
        value_ = &k_empty_object;
    }
}

const nlohmann::json* JsonObject::find(const char* key) {
    asked_.emplace_back(key);
    auto found = value_->find(key);
    return found == value_->end() ? nullptr : &*found;
}

bool JsonObject::has(const char* key) { return find(key) != nullptr; }

std::string JsonObject::place_of(const char* key) const { return place_.empty() ? key : place_ + "." + key; }

void JsonObject::report(ErrorId id, const char* key, std::string fault, std::string remedy) {
    document_->report(id, place_of(key), std::move(fault), std::move(remedy));
}

double JsonObject::number(const char* key, double low, double high, std::optional<double> otherwise) {
    const nlohmann::json* value = find(key);
    if (value && within(*value, low, high)) return value->get<double>();
    if (value)
        report(ErrorId::value_out_of_range, key, "found " + shown(*value), "write " + range_text(low, high));
    else if (!otherwise)
        report(ErrorId::syntax, key, "missing", "write " + range_text(low, high));
    return otherwise.value_or(low);
}

float JsonObject::real(const char* key, float low, float high, std::optional<float> otherwise) {
    std::optional<double> wide;
    if (otherwise) wide = double(*otherwise);
    return float(number(key, double(low), double(high), wide));
}

uint64_t JsonObject::whole(const char* key, uint64_t low, uint64_t high, std::optional<uint64_t> otherwise) {
    const nlohmann::json* value = find(key);
    // What a program put together is signed where it comes from signed numbers.
    if (value && (value->is_number_unsigned() || (value->is_number_integer() && value->get<int64_t>() >= 0))) {
        uint64_t number = value->get<uint64_t>();
        if (number >= low && number <= high) return number;
    }
    std::string remedy = fmt::format("write a whole number from {} to {}", low, high);
    if (value)
        report(ErrorId::value_out_of_range, key, "found " + shown(*value), remedy);
    else if (!otherwise)
        report(ErrorId::syntax, key, "missing", remedy);
    return otherwise.value_or(low);
}

bool JsonObject::truth(const char* key, bool otherwise) {
    const nlohmann::json* value = find(key);
    if (!value) return otherwise;
    if (value->is_boolean()) return value->get<bool>();
    report(ErrorId::syntax, key, "found " + shown(*value), "write true or false");
    return otherwise;
}

std::string JsonObject::text(const char* key, std::optional<std::string> otherwise) {
    const nlohmann::json* value = find(key);
    if (value && value->is_string() && !value->get_ref<const std::string&>().empty())
        return value->get<std::string>();
    if (value)
        report(ErrorId::syntax, key, "found " + shown(*value), "write a text in quotes");
    else if (!otherwise)
        report(ErrorId::syntax, key, "missing", "write a text in quotes");
    return otherwise.value_or("");
}

std::vector<double> JsonObject::numbers(const char* key, size_t count, double low, double high,
                                        std::optional<std::vector<double>> otherwise) {
    const nlohmann::json* value = find(key);
    std::string remedy = fmt::format("write a list of {} numbers from {:g} to {:g}", count, low, high);
    if (value) {
        if (value->is_array() && value->size() == count &&
            std::all_of(value->begin(), value->end(), [=](const auto& v) { return within(v, low, high); }))
            return value->get<std::vector<double>>();
        report(ErrorId::value_out_of_range, key, "found " + shown(*value), remedy);
    } else if (!otherwise) {
        report(ErrorId::syntax, key, "missing", remedy);
    }
    return otherwise.value_or(std::vector<double>(count, low));
}

vec3 JsonObject::color(const char* key, float high, vec3 otherwise) {
    auto rgb = numbers(key, 3, 0.0, double(high),
                       std::vector<double>{double(otherwise.x), double(otherwise.y), double(otherwise.z)});
    return vec3(float(rgb[0]), float(rgb[1]), float(rgb[2]));
}

JsonObject JsonObject::object(const char* key) {
    const nlohmann::json* value = find(key);
    if (!value) report(ErrorId::syntax, key, "missing", "write an object: { ... }");
    return JsonObject(*document_, value ? *value : k_empty_object, place_of(key));
}

std::vector<JsonObject> JsonObject::objects(const char* key) {
    const nlohmann::json* value = find(key);
    std::vector<JsonObject> list;
    if (!value || !value->is_array()) {
        report(ErrorId::syntax, key, value ? "found " + shown(*value) : "missing",
               "write a list of objects: [{ ... }]");
        return list;
    }
    for (size_t i = 0; i < value->size(); ++i)
        list.emplace_back(*document_, (*value)[i], fmt::format("{}[{}]", place_of(key), i));
    return list;
}

size_t JsonObject::one_of(std::initializer_list<const char*> keys) {
    size_t found = 0, count = 0, index = 0;
    for (const char* key : keys) {
        if (has(key)) {
            found = index;
            ++count;
        }
        ++index;
    }
    if (count != 1)
        document_->report(ErrorId::syntax, place_,
                          count == 0 ? "none of its kinds given" : "several kinds given",
                          fmt::format("write exactly one of: {}", fmt::join(keys, ", ")));
    return found;
}

void JsonObject::close() {
    for (const auto& [key, value] : value_->items())
        if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
            document_->report(ErrorId::name_unknown, place_, fmt::format("unknown key '{}'", key),
                              known_names(key, asked_));
}

}  // namespace coppice
