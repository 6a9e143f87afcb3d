#include "plugins/vegetation/cook/import/simplify_outline.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace coppice {
namespace {

constexpr uint32_t k_none = UINT32_MAX;
// Rings may vanish until the total area has changed by this share, which is then given back to the others.
constexpr double k_vanished_share = 0.05;

struct Corner {
    dvec2 at;
    uint32_t previous, next;
    uint32_t version = 0;  // changes with everything that a collapse at this corner depends on
    bool alive = true;
};

// A possible step: corner b and the next one become one at `at`; or, where `vanish`, b's ring of three goes.
struct Step {
    double cost;  // displaced area
    uint32_t b;
    uint32_t version;
    bool vanish;
    dvec2 at;
    bool operator>(const Step& other) const {
        return std::tie(cost, b, version) > std::tie(other.cost, other.b, other.version);
    }
};

// Corners and the segments that start at them, by cell. Entries of dead corners are skipped and swept out
// when met.
class CornerGrid {
  public:
    CornerGrid(const OutlineLimits& limits, size_t corner_count) : low_(limits.low) {
        side_ = std::clamp(uint32_t(std::sqrt(double(corner_count))), 1u, 512u);
        dvec2 size = limits.high - limits.low;
        cell_ = dvec2(std::max(size.x, 1.0e-9), std::max(size.y, 1.0e-9)) / double(side_);
        cells_.resize(size_t(side_) * side_);
    }
    template <class Visit>
    void for_cells(dvec2 a, dvec2 b, Visit&& visit) {
        uint32_t x0 = index(std::min(a.x, b.x), 0), x1 = index(std::max(a.x, b.x), 0);
        uint32_t y0 = index(std::min(a.y, b.y), 1), y1 = index(std::max(a.y, b.y), 1);
        for (uint32_t y = y0; y <= y1; ++y)
            for (uint32_t x = x0; x <= x1; ++x) visit(cells_[size_t(y) * side_ + x]);
    }

  private:
    uint32_t index(double v, int axis) const {
        double i = (v - low_[axis]) / cell_[axis];
        return uint32_t(std::clamp(i, 0.0, double(side_ - 1)));
    }
    dvec2 low_, cell_;
    uint32_t side_;
    std::vector<std::vector<uint32_t>> cells_;
};

dvec2 direction(dvec2 from, dvec2 to) {
    double length = glm::length(to - from);
    return length > 0.0 ? (to - from) / length : dvec2(0.0);
}

bool crosses(dvec2 a, dvec2 b, dvec2 c, dvec2 d) {
    double c_side = cross_at(a, b, c), d_side = cross_at(a, b, d);
    double a_side = cross_at(c, d, a), b_side = cross_at(c, d, b);
    if ((c_side > 0) == (d_side > 0) && c_side != 0 && d_side != 0) return false;
    if ((a_side > 0) == (b_side > 0) && a_side != 0 && b_side != 0) return false;
    // On one line: only where the spans meet.
    return std::max(std::min(a.x, b.x), std::min(c.x, d.x)) <=
               std::min(std::max(a.x, b.x), std::max(c.x, d.x)) &&
           std::max(std::min(a.y, b.y), std::min(c.y, d.y)) <=
               std::min(std::max(a.y, b.y), std::max(c.y, d.y));
}

bool in_triangle(dvec2 p, dvec2 a, dvec2 b, dvec2 c) {
    if (cross_at(a, b, c) == 0.0) return false;
    double ab = cross_at(a, b, p), bc = cross_at(b, c, p), ca = cross_at(c, a, p);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

class Simplifier {
  public:
    Simplifier(const std::vector<Ring>& rings, const OutlineLimits& limits)
        : limits_(limits), grid_(limits, count(rings)) {
        for (const Ring& ring : rings) {
            uint32_t first = uint32_t(corners_.size()), n = uint32_t(ring.size());
            firsts_.push_back(first);
            for (uint32_t i = 0; i < n; ++i)
                corners_.push_back({ring[i], first + (i + n - 1) % n, first + (i + 1) % n});
            total_area_ += signed_area(ring);
        }
        alive_count_ = corners_.size();
        for (uint32_t i = 0; i < corners_.size(); ++i) insert(i);
        for (uint32_t i = 0; i < corners_.size(); ++i) propose(i);
    }

    std::vector<Ring> run() {
        while (!steps_.empty()) {
            Step step = steps_.top();
            steps_.pop();
            if (!corners_[step.b].alive || corners_[step.b].version != step.version) continue;
            if (displaced_area_ + step.cost > limits_.displaced_area && alive_count_ <= limits_.corner_count)
                break;
            if (step.vanish)
                vanish(step);
            else if (is_free(step))
                collapse(step);
        }
        std::vector<Ring> rings = collect();
        give_back(rings);
        return rings;
    }

  private:
    static size_t count(const std::vector<Ring>& rings) {
        size_t corners = 0;
        for (const Ring& ring : rings) corners += ring.size();
        return corners;
    }

    void insert(uint32_t i) {
        grid_.for_cells(corners_[i].at, corners_[corners_[i].next].at,
                        [i](std::vector<uint32_t>& cell) { cell.push_back(i); });
    }

    // The step at b, whatever stands in its way.
    void propose(uint32_t b) {
        const Corner& corner = corners_[b];
        uint32_t a = corner.previous, c = corner.next, d = corners_[c].next;
        dvec2 A = corners_[a].at, B = corner.at, C = corners_[c].at, D = corners_[d].at;
        if (d == a) {
            if (b < a && b < c) steps_.push({std::fabs(cross_at(A, B, C)) * 0.5, b, corner.version, true, B});
            return;
        }
        double twice_area = cross_at(A, B, C) + cross_at(A, C, D);
        // E on the line A-B, or on D-C, such that triangle A E D has the area of A B C D.
        double on_ab = -cross_at(A, D, B), on_dc = -cross_at(A, D, C);
        double scale = (std::fabs(D.x - A.x) + std::fabs(D.y - A.y)) * 1.0e-12;
        Step best{INFINITY, b, corner.version, false, B};
        if (std::fabs(on_ab) > scale) {
            dvec2 E = A + (B - A) * (twice_area / on_ab);
            consider(best, E, displaced(E, B, C, D));
        }
        if (std::fabs(on_dc) > scale) {
            dvec2 E = D + (C - D) * (twice_area / on_dc);
            consider(best, E, displaced(E, C, B, A));
        }
        if (std::fabs(on_ab) <= scale && std::fabs(on_dc) <= scale) consider(best, (B + C) * 0.5, 0.0);
        if (best.cost < INFINITY) steps_.push(best);
    }

    void consider(Step& best, dvec2 E, double cost) const {
        if (!(E.x >= limits_.low.x && E.y >= limits_.low.y && E.x <= limits_.high.x && E.y <= limits_.high.y))
            return;
        if (cost < best.cost) {
            best.cost = cost;
            best.at = E;
        }
    }

    // E lies on the line through B's other neighbour and B; the path E B C D becomes E D.
    static double displaced(dvec2 E, dvec2 B, dvec2 C, dvec2 D) {
        double b_side = cross_at(E, D, B), c_side = cross_at(E, D, C);
        double whole = std::fabs(cross_at(E, B, C));
        return (b_side > 0) != (c_side > 0) && b_side != c_side
                   ? whole * std::fabs(b_side / (b_side - c_side))
                   : whole;
    }

    // Whether the new pieces cross nothing, and no corner lies in what changes sides.
    bool is_free(const Step& step) {
        uint32_t b = step.b, a = corners_[b].previous, c = corners_[b].next, d = corners_[c].next;
        dvec2 A = corners_[a].at, B = corners_[b].at, C = corners_[c].at, D = corners_[d].at, E = step.at;
        if (E == A || E == D) return false;
        dvec2 low = glm::min(glm::min(A, B), glm::min(glm::min(C, D), E));
        dvec2 high = glm::max(glm::max(A, B), glm::max(glm::max(C, D), E));
        bool free = true;
        grid_.for_cells(low, high, [&](std::vector<uint32_t>& cell) {
            if (!free) return;
            size_t kept = 0;
            for (uint32_t i : cell) {
                if (!corners_[i].alive) continue;
                cell[kept++] = i;
                if (!free || i == b || i == c || i == a) continue;  // a's piece is one that goes
                uint32_t next = corners_[i].next;
                dvec2 P = corners_[i].at, Q = corners_[next].at;
                if (i != d && (in_triangle(P, E, B, C) || in_triangle(P, E, C, D) || in_triangle(P, A, B, E)))
                    free = false;
                // Neighbours share an end with a new piece; they may not turn back onto it.
                if (i != d && next != a && (crosses(A, E, P, Q) || crosses(E, D, P, Q))) free = false;
                if (i == d && next != a && (crosses(A, E, P, Q) || folds(E, D, Q))) free = false;
                if (next == a && i != d && (crosses(E, D, P, Q) || folds(E, A, P))) free = false;
            }
            cell.resize(kept);
        });
        return free;
    }

    // Whether the path from, corner, to turns back onto itself.
    static bool folds(dvec2 from, dvec2 corner, dvec2 to) {
        return cross_at(from, corner, to) == 0.0 && glm::dot(from - corner, to - corner) > 0.0;
    }

    void collapse(const Step& step) {
        uint32_t b = step.b, c = corners_[b].next, d = corners_[c].next;
        corners_[b].at = step.at;
        corners_[b].next = d;
        corners_[d].previous = b;
        corners_[c].alive = false;
        --alive_count_;
        displaced_area_ += step.cost;
        uint32_t a = corners_[b].previous;
        insert(a);
        insert(b);
        // Everything that saw one of the moved corners: steps at a's previous, a, b and d.
        for (uint32_t i : {corners_[a].previous, a, b, d}) {
            ++corners_[i].version;
            propose(i);
        }
    }

    void vanish(const Step& step) {
        uint32_t b = step.b, a = corners_[b].previous, c = corners_[b].next;
        double area = cross_at(corners_[a].at, corners_[b].at, corners_[c].at) * 0.5;
        if (std::fabs(vanished_area_ + area) > k_vanished_share * std::fabs(total_area_)) return;
        vanished_area_ += area;
        displaced_area_ += step.cost;
        for (uint32_t i : {a, b, c}) corners_[i].alive = false;
        alive_count_ -= 3;
    }

    // Moves all outlines a little, in or out, until the area is again what it was. Twice, because corners
    // round it off.
    void give_back(std::vector<Ring>& rings) const {
        for (int round = 0; round < 2; ++round) {
            double missing = total_area_, length = 0.0;
            for (const Ring& ring : rings) {
                missing -= signed_area(ring);
                for (size_t i = 0; i < ring.size(); ++i)
                    length += glm::length(ring[(i + 1) % ring.size()] - ring[i]);
            }
            if (!(length > 0.0)) return;
            double outward = missing / length;
            for (Ring& ring : rings) {
                Ring old = ring;
                for (size_t i = 0; i < old.size(); ++i) {
                    dvec2 in = direction(old[(i + old.size() - 1) % old.size()], old[i]);
                    dvec2 out = direction(old[i], old[(i + 1) % old.size()]);
                    dvec2 both(in.y + out.y, -in.x - out.x);  // sum of the two sides' outward normals
                    ring[i] += both * (outward / std::max(1.0 + glm::dot(in, out), 0.25));
                    ring[i] = glm::clamp(ring[i], limits_.low, limits_.high);
                }
            }
        }
    }

    std::vector<Ring> collect() const {
        std::vector<Ring> rings;
        for (size_t r = 0; r < firsts_.size(); ++r) {
            uint32_t end = r + 1 < firsts_.size() ? firsts_[r + 1] : uint32_t(corners_.size()),
                     start = firsts_[r];
            while (start < end && !corners_[start].alive) ++start;
            if (start == end) continue;
            Ring& ring = rings.emplace_back();
            uint32_t at = start;
            do {
                ring.push_back(corners_[at].at);
                at = corners_[at].next;
            } while (at != start);
        }
        return rings;
    }

    OutlineLimits limits_;
    CornerGrid grid_;
    std::vector<Corner> corners_;
    std::vector<uint32_t> firsts_;  // of each ring
    std::priority_queue<Step, std::vector<Step>, std::greater<Step>> steps_;
    size_t alive_count_ = 0;
    double total_area_ = 0.0, displaced_area_ = 0.0, vanished_area_ = 0.0;
};

}  // namespace

std::vector<Ring> simplify_outline(const std::vector<Ring>& rings, const OutlineLimits& limits) {
    return Simplifier(rings, limits).run();
}

}  // namespace coppice
