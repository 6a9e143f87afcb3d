#include "tools/accuracy/accuracy_tables.h"

#include <cmath>
#include <optional>
#include <fmt/format.h>
#include "tools/accuracy/accuracy_summary.h"

namespace coppice {
namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
json number(const std::optional<double>& value) { return value ? number(*value) : json(nullptr); }

json errors_json(const FrameErrors& errors) {
    json object = json::object();
    for (const ErrorColumn& column : k_error_columns) object[column.name] = number(errors.*column.field);
    return object;
}

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::string csv_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

json accuracy_json(const AccuracyRecord& record) {
    json views = json::array(), methods = json::array(), samples = json::array(), resting = json::array(),
         figures = json::array();
    for (const AccuracyView& view : record.views)
        views.push_back({{"name", view.name},
                         {"reference_file", view.reference_file},
                         {"plant_coverage", number(view.plant_coverage)}});
    for (const AccuracyMethodRecord& method : record.methods)
        methods.push_back({{"name", method.name},
                           {"what", method.what},
                           {"quality_name", method.quality_name},
                           {"is_default", method.is_default},
                           {"default_quality", number(method.default_quality)},
                           {"pop_energy", number(method.pop_energy)},
                           {"shimmer", number(method.shimmer)}});
    for (const AccuracySample& sample : record.samples)
        samples.push_back({{"method", sample.method},
                           {"view", sample.view},
                           {"quality", number(sample.quality)},
                           {"frame_ms", number(sample.frame_ms)},
                           {"triangles", sample.triangles},
                           {"lines", sample.lines},
                           {"points", sample.points},
                           {"geometry_bytes", sample.geometry_bytes},
                           {"list_bytes", sample.list_bytes},
                           {"errors", errors_json(sample.errors)},
                           {"unshadowed_errors", errors_json(sample.unshadowed_errors)},
                           {"picture_file", sample.picture_file},
                           {"flip_file", sample.flip_file}});
    for (const AccuracyRecord::Resting& entry : record.resting)
        resting.push_back({{"view", entry.view},
                           {"frames", entry.frames},
                           {"total_ms", number(entry.total_ms)},
                           {"errors", errors_json(entry.errors)},
                           {"unshadowed_errors", errors_json(entry.unshadowed_errors)}});
    for (const Figure& figure : record.figures) {
        json entry = to_json(figure);
        entry["value"] = number(figure.value);
        figures.push_back(std::move(entry));
    }
    return {{"name", "accuracy"},
            {"command", record.command},
            {"scene", record.scene_name},
            {"width", record.width},
            {"height", record.height},
            {"reference_samples", record.reference_samples},
            {"device", record.device},
            {"driver", record.driver},
            {"machine", record.machine},
            {"date", record.date},
            {"plants", record.plants},
            {"scene_triangles", record.scene_triangles},
            {"duration_s", number(record.duration_s)},
            {"views", std::move(views)},
            {"methods", std::move(methods)},
            {"full_method", record.full_method},
            {"samples", std::move(samples)},
            {"resting", std::move(resting)},
            {"figures", std::move(figures)}};
}

std::string accuracy_csv(const AccuracyRecord& record) {
    std::string csv = "method,quality,view,frame_ms,triangles,lines,points,geometry_bytes,list_bytes";
    for (const char* prefix : {"", "unshadowed_"})
        for (const ErrorColumn& column : k_error_columns) csv += fmt::format(",{}{}", prefix, column.name);
    csv += '\n';
    for (const AccuracySample& sample : record.samples) {
        csv += fmt::format("{},{},{},{},{},{},{},{},{}", csv_text(record.methods[sample.method].name),
                           csv_number(sample.quality), csv_text(record.views[sample.view].name),
                           csv_number(sample.frame_ms), sample.triangles, sample.lines, sample.points,
                           sample.geometry_bytes, sample.list_bytes);
        for (const FrameErrors* errors : {&sample.errors, &sample.unshadowed_errors})
            for (const ErrorColumn& column : k_error_columns) csv += ',' + csv_number(errors->*column.field);
        csv += '\n';
    }
    return csv;
}

}  // namespace coppice
