// What a frame costs on this machine, learned from frames it drew, so that a time budget becomes a vertex budget
// (DESIGN section 3: budget). ms = frame + triangles, lines, points and leaves times a cost each, by recursive least squares.
// Forgetting is directional (Cao and Schwartz 2000): only what a frame tells about is forgotten for it, so that a view at
// rest neither blows anything up nor loses what was learned of kinds it does not show.
// Pure and in double precision: same frames, same bits.
#pragma once
#include <array>
#include <cstdint>

namespace coppice {

struct PrimitiveCounts {
    uint64_t triangles = 0, lines = 0, points = 0, leaves = 0;
};

// All >= 0.
struct PrimitiveCosts {
    double frame_ms = 0.0;  // whatever is drawn: clear, resolve, what the host adds
    double triangle_ns = 0.0, line_ns = 0.0, point_ns = 0.0, leaf_ns = 0.0;
    double ms_of(const PrimitiveCounts& counts) const;
};

class LearnedCost {
  public:
    // What was drawn and how long it took. Times that are not finite or not above zero are ignored. A hitch changes
    // little, the first frame's too; what lasts for eight frames is no hitch.
    void learn(const PrimitiveCounts& counts, double measured_ms);

    // Before the first frame, two cores of lavapipe's.
    PrimitiveCosts costs() const;

    // Vertices (one a point, two a line, three a triangle, four a leaf) that take budget_ms when drawn in the proportions of `mix`;
    // an empty mix: of the dearest kind. 0 where the frame alone takes as long, or budget_ms is not a number. At most 2^40.
    uint64_t vertex_budget_for(double budget_ms, const PrimitiveCounts& mix) const;

  private:
    static constexpr int k_terms = 5;         // frame, triangles, lines, points, leaves
    static constexpr int k_first_frames = 5;  // of which the median says how fast the machine is
    static constexpr int k_lasting_frames = 8;
    using Terms = std::array<double, k_terms>;

    double expected_ms(const Terms& usual_ms) const;
    void scale_to(double ratio);
    void update(const Terms& share, double error, double weight);

    Terms factors_{1.0, 1.0, 1.0, 1.0};  // of the usual costs
    std::array<Terms, k_terms>
        information_{};    // of the factors over scale_, frames' relative errors being one
    double scale_ = 1.0;   // how much slower than usual the machine is
    double spread_ = 0.1;  // mean relative error of a frame
    std::array<double, k_first_frames> first_ratios_{};  // sorted
    int first_frames_ = 0;
    int run_ = 0;  // outliers in a row: > 0 slow, < 0 fast
};

}  // namespace coppice
