// What a reader of an accuracy record asks first: averages over the views, and which method to use at a
// budget.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include "tools/accuracy/accuracy_record.h"

namespace coppice {

struct ErrorColumn {
    const char* name;
    double FrameErrors::*field;
};
inline constexpr ErrorColumn k_error_columns[] = {{"rmse", &FrameErrors::rmse},
                                                  {"psnr_db", &FrameErrors::psnr_db},
                                                  {"flip", &FrameErrors::flip},
                                                  {"coverage", &FrameErrors::coverage},
                                                  {"coverage_bias", &FrameErrors::coverage_bias},
                                                  {"mean_color", &FrameErrors::mean_color},
                                                  {"mean_color_bias", &FrameErrors::mean_color_bias}};

enum class Truth { shadowed, unshadowed };  // the reference with shadows; the one lit as frames are

// A method at one setting of its quality, in one view or averaged over all of them. Counts and bytes are of a
// frame.
struct MethodPoint {
    uint32_t method;  // into AccuracyRecord::methods
    double quality;
    double frame_ms;
    double triangles, lines, points, geometry_bytes, list_bytes;
    FrameErrors errors, unshadowed_errors;

    const FrameErrors& against(Truth truth) const {
        return truth == Truth::shadowed ? errors : unshadowed_errors;
    }
};

// Sorted by method, then as the record has them: that is the order of the sweep.
std::vector<MethodPoint> view_points(const AccuracyRecord& record, uint32_t view);
// Arithmetic means. Settings not measured in every view are left out: a mean over easier views would look
// better.
std::vector<MethodPoint> mean_points(const AccuracyRecord& record);

// The point of the least FLIP that takes at most budget_ms; of equal ones the quicker, then the first. Empty
// where none is as quick.
std::optional<MethodPoint> best_within(std::span<const MethodPoint> points, double budget_ms,
                                       Truth truth = Truth::shadowed);
// Of the means.
std::optional<MethodPoint> best_within(const AccuracyRecord& record, double budget_ms,
                                       Truth truth = Truth::shadowed);

// The method marked as default, else the full one.
uint32_t default_method(const AccuracyRecord& record);
// The method's point whose quality is nearest to its default. Empty: not measured.
std::optional<MethodPoint> point_at_default(const AccuracyRecord& record, std::span<const MethodPoint> points,
                                            uint32_t method);

// "d' 0.5 px"; "" where there is nothing to sweep.
std::string setting_text(const AccuracyMethodRecord& method, double quality);

}  // namespace coppice
