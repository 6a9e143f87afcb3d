#include "plugins/modeller/read_json.h"

#include <algorithm>

namespace coppice::modeller {
namespace {

const nlohmann::json k_empty_object = nlohmann::json::object();

size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (size_t i = 0; i < a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < b.size(); ++j) {
            size_t above = row[j + 1];
            row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] == b[j] ? 0 : 1)});
            diagonal = above;
        }
    }
    return row[b.size()];
}

// What was found, short enough for one line.
std::string shown(const nlohmann::json& value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return fmt::format("an array of {}", value.size());
    std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& words) {
    std::string nearest;
    size_t least = SIZE_MAX;
    for (const std::string& candidate : words) {
        size_t distance = edit_distance(word.substr(0, 64), candidate);
        if (distance < least) {
            least = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

JsonReader::JsonReader(const nlohmann::json& value, std::string file, std::string place,
                       std::optional<Error>& first_error)
    : value_(&value), file_(std::move(file)), place_(std::move(place)), first_error_(&first_error) {
    if (!value.is_object()) {
        refuse(ErrorId::syntax, "", fmt::format("found {}", shown(value)), "write an object, { ... }");
        value_ = &k_empty_object;
    }
}

std::string JsonReader::place_of(const std::string& key) const {
    if (key.empty()) return place_;
    return place_.empty() ? key : place_ + "." + key;
}

void JsonReader::refuse(ErrorId id, const std::string& key, std::string fault, std::string remedy) {
    if (!*first_error_) *first_error_ = Error{id, file_, place_of(key), std::move(fault), std::move(remedy)};
}

const nlohmann::json* JsonReader::take(const char* key) {
    known_.emplace_back(key);
    auto found = value_->find(key);
    return found == value_->end() ? nullptr : &*found;
}

bool JsonReader::has(const char* key) { return value_->contains(key); }

void JsonReader::number(const char* key, float& value, float low, float high) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    double read = found->is_number() ? found->get<double>() : NAN;
    if (!(read >= double(low) && read <= double(high))) {
        refuse(ErrorId::value_out_of_range, key, fmt::format("found {}", shown(*found)),
               fmt::format("write a number from {} to {}", low, high));
        return;
    }
    value = float(read);
}

void JsonReader::angle_deg(const char* key, float& value_rad, float low_deg, float high_deg) {
    float value_deg = value_rad * (180.0f / k_pi);
    if (!has(key)) {
        known_.emplace_back(key);
        return;
    }
    number(key, value_deg, low_deg, high_deg);
    value_rad = value_deg * (k_pi / 180.0f);
}

void JsonReader::count(const char* key, uint32_t& value, uint32_t low, uint32_t high) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    // Whole numbers beyond 64 bits are read as floating point, so range is what decides.
    double read = found->is_number() ? found->get<double>() : NAN;
    if (found->is_number() && read > double(high)) {
        refuse(ErrorId::limit_exceeded, key, fmt::format("found {}", shown(*found)),
               fmt::format("write a whole number from {} to {}", low, high));
    } else if (!(read >= double(low)) || !found->is_number_integer()) {
        refuse(ErrorId::value_out_of_range, key, fmt::format("found {}", shown(*found)),
               fmt::format("write a whole number from {} to {}", low, high));
    } else {
        value = found->get<uint32_t>();
    }
}

void JsonReader::seed(const char* key, uint64_t& value) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    if (!found->is_number_unsigned()) {
        refuse(ErrorId::value_out_of_range, key, fmt::format("found {}", shown(*found)),
               "write a whole number, 0 or more");
        return;
    }
    value = found->get<uint64_t>();
}

void JsonReader::text(const char* key, std::string& value) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    if (!found->is_string()) {
        refuse(ErrorId::value_out_of_range, key, fmt::format("found {}", shown(*found)),
               "write a text in quotes");
        return;
    }
    value = found->get<std::string>();
}

void JsonReader::color(const char* key, vec3& value) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    bool right = found->is_array() && found->size() == 3;
    vec3 read(0);
    for (int i = 0; right && i < 3; ++i) {
        const nlohmann::json& channel = (*found)[size_t(i)];
        double number = channel.is_number() ? channel.get<double>() : NAN;
        right = number >= 0.0 && number <= 1.0;
        if (right) read[i] = float(number);
    }
    if (!right) {
        refuse(
            ErrorId::value_out_of_range, key,
            fmt::format("found {}", found->is_array() && found->size() == 3 ? found->dump() : shown(*found)),
            "write linear red, green and blue, three numbers from 0 to 1");
        return;
    }
    value = read;
}

void JsonReader::word(const char* key, uint32_t& value, std::initializer_list<const char*> words) {
    const nlohmann::json* found = take(key);
    if (!found) return;
    std::vector<std::string> all(words.begin(), words.end());
    if (found->is_string()) {
        for (size_t i = 0; i < all.size(); ++i) {
            if (*found->get_ptr<const std::string*>() == all[i]) {
                value = uint32_t(i);
                return;
            }
        }
    }
    std::string list;
    for (const std::string& each : all) list += (list.empty() ? "" : ", ") + each;
    refuse(ErrorId::name_unknown, key, fmt::format("found {}", shown(*found)),
           fmt::format("write one of {}", list));
}

JsonReader JsonReader::object(const char* key) {
    const nlohmann::json* found = take(key);
    return JsonReader(found ? *found : k_empty_object, file_, place_of(key), *first_error_);
}

std::vector<JsonReader> JsonReader::array(const char* key, size_t least, size_t most) {
    const nlohmann::json* found = take(key);
    std::vector<JsonReader> readers;
    size_t size = found && found->is_array() ? found->size() : 0;
    if ((found && !found->is_array()) || size < least || size > most) {
        refuse(size > most ? ErrorId::limit_exceeded : ErrorId::value_out_of_range, key,
               found ? fmt::format("found {}", shown(*found)) : "missing",
               fmt::format("write an array of {} to {} objects", least, most));
        return readers;
    }
    for (size_t i = 0; i < size; ++i) {
        readers.push_back(
            JsonReader((*found)[i], file_, fmt::format("{}[{}]", place_of(key), i), *first_error_));
    }
    return readers;
}

void JsonReader::finish() {
    for (const auto& item : value_->items()) {
        if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
        refuse(ErrorId::name_unknown, item.key().substr(0, 64), "unknown key",
               fmt::format("the nearest known one is \"{}\"", nearest_word(item.key(), known_)));
        return;
    }
}

}  // namespace coppice::modeller
