#include "plugins/vegetation/eco/read_placements_csv.h"

#include <charconv>
#include <fmt/format.h>
#include "plugins/vegetation/eco/ground_height.h"
#include "runtime/core/log.h"
#include "runtime/core/mapped_file.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

enum Column { k_x, k_y, k_species, k_height, k_diameter, k_column_count };
constexpr const char* k_column_names[k_column_count] = {"x", "y", "species", "height", "diameter"};

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
        text.remove_suffix(1);
    return text;
}

// false: a quote that does not end. Quotes inside a quoted field are written twice.
bool split_line(std::string_view line, char separator, std::vector<std::string>& fields) {
    fields.clear();
    size_t at = 0;
    while (true) {
        std::string field;
        while (at < line.size() && line[at] == ' ') ++at;
        if (at < line.size() && line[at] == '"') {
            for (++at;; ++at) {
                if (at >= line.size()) return false;
                if (line[at] == '"') {
                    if (at + 1 >= line.size() || line[at + 1] != '"') break;
                    ++at;
                }
                field += line[at];
            }
            at = std::min(line.find(separator, at), line.size());
        } else {
            size_t end = std::min(line.find(separator, at), line.size());
            field = trim(line.substr(at, end - at));
            at = end;
        }
        fields.push_back(std::move(field));
        if (at >= line.size()) return true;
        ++at;
    }
}

}  // namespace

Result<std::vector<Placement>> read_placements_csv(const std::string& path, const CsvSettings& settings) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    std::string_view text(reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size());
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // UTF-8 mark

    std::vector<std::string> known;
    for (const auto& [name, kind] : settings.kinds) known.push_back(name);
    std::vector<Placement> plants;
    std::vector<std::string> fields;
    size_t columns[k_column_count];
    size_t header_fields = 0;
    char separator = ',';
    size_t line_number = 0;
    while (!text.empty()) {
        size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        std::string place = fmt::format("line {}", ++line_number);
        if (line.empty()) continue;
        bool header = header_fields == 0;
        if (header && line.find(',') == line.npos) separator = line.find(';') != line.npos ? ';' : '\t';
        if (!split_line(line, separator, fields))
            return fail(ErrorId::syntax, path, place, "a quote does not end", "close it with \"");

        if (header) {
            header_fields = fields.size();
            std::string ignored;
            for (size_t& column : columns) column = size_t(-1);
            for (size_t f = 0; f < fields.size(); ++f) {
                size_t column = 0;
                while (column < k_column_count && fields[f] != k_column_names[column]) ++column;
                if (column == k_column_count)
                    ignored += (ignored.empty() ? "" : ", ") + fields[f];
                else if (columns[column] != size_t(-1))
                    return fail(ErrorId::syntax, path, place, "column '" + fields[f] + "' twice",
                                "name each once");
                else
                    columns[column] = f;
            }
            for (size_t column = 0; column <= k_species; ++column)
                if (columns[column] == size_t(-1))
                    return fail(
                        ErrorId::syntax, path, place, fmt::format("no column '{}'", k_column_names[column]),
                        "the first line names the columns: x, y, species, and if known height, diameter");
            if (!ignored.empty()) log_note("{}: columns not used: {}", path, ignored);
            continue;
        }

        if (fields.size() != header_fields)
            return fail(ErrorId::syntax, path, place, fmt::format("{} fields", fields.size()),
                        fmt::format("{}, as the header has", header_fields));
        if (plants.size() >= k_plant_limit)
            return fail(ErrorId::limit_exceeded, path, place, "too many plants",
                        fmt::format("at most {}", k_plant_limit));
        auto number = [&](Column column, double low, double high, double& value) -> Status {
            const std::string& field = fields[columns[column]];
            auto [stop, fault] = std::from_chars(field.data(), field.data() + field.size(), value);
            if (fault == std::errc() && stop == field.data() + field.size() && value >= low && value <= high)
                return {};
            return fail(ErrorId::value_out_of_range, path, place,
                        fmt::format("{} is '{}'", k_column_names[column], field.substr(0, 40)),
                        fmt::format("a number from {:g} to {:g}, with a point", low, high));
        };
        auto given = [&](Column column) {
            return columns[column] != size_t(-1) && !fields[columns[column]].empty();
        };
        double x = 0.0, y = 0.0, height = 0.0, diameter = 0.0;
        COPPICE_CHECK(number(k_x, -k_farthest_m, k_farthest_m, x));
        COPPICE_CHECK(number(k_y, -k_farthest_m, k_farthest_m, y));
        if (given(k_height)) COPPICE_CHECK(number(k_height, 0.001, 200.0, height));
        if (given(k_diameter)) COPPICE_CHECK(number(k_diameter, 0.0, 50.0, diameter));
        const std::string& species = fields[columns[k_species]];
        auto kind = settings.kinds.find(species);
        if (kind == settings.kinds.end())
            return fail(ErrorId::name_unknown, path, place,
                        fmt::format("unknown species '{}'", species.substr(0, 40)),
                        known_names(species.substr(0, 40), known));
        if (height > 0.0 && !(kind->second.height_m > 0.0f))
            return fail(ErrorId::value_out_of_range, path, place,
                        fmt::format("a height of '{}', whose model's height is not known", species),
                        "give \"height_m\" of that plant in the scene");

        Random random(settings.seed, line_number);
        Placement plant;
        x += settings.offset.x;
        y += settings.offset.y;
        plant.position_world = dvec3(x, ground_height(settings.terrain, x, y), y);
        const std::vector<PlantIndividual>& individuals = kind->second.individuals;
        const PlantIndividual& individual = individuals[random.next_below(uint32_t(individuals.size()))];
        plant.model = {individual.model, uint32_t(random.next_bits() >> 32)};
        plant.turn = pack_turn_about_y(random.next_unit() * 2.0f * k_pi);
        float scale = random.next_in(settings.scale_low, settings.scale_high);
        plant.scale = (height > 0.0 ? float(height) / kind->second.height_m : scale) * individual.scale;
        plants.push_back(plant);
    }
    if (header_fields == 0)
        return fail(ErrorId::syntax, path, "line 1", "no header",
                    "the first line names the columns: x, y, species, and if known height, diameter");
    return plants;
}

}  // namespace coppice
