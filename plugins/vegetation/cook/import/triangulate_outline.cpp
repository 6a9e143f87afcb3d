#include "plugins/vegetation/cook/import/triangulate_outline.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace coppice {
namespace {

bool contains(const Ring& ring, dvec2 p) {
    bool inside = false;
    for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        if ((ring[i].y > p.y) != (ring[j].y > p.y) &&
            p.x < (ring[j].x - ring[i].x) * (p.y - ring[i].y) / (ring[j].y - ring[i].y) + ring[i].x)
            inside = !inside;
    return inside;
}

// A ring of indices into corners, which may pass one corner twice (bridges to holes).
using Loop = std::vector<uint32_t>;

class Triangulator {
  public:
    explicit Triangulator(const std::vector<Ring>& rings) {
        std::vector<double> areas;
        for (const Ring& ring : rings) areas.push_back(signed_area(ring));
        // Each hole belongs to the smallest outer ring around it.
        std::vector<std::vector<size_t>> holes(rings.size());
        for (size_t h = 0; h < rings.size(); ++h) {
            if (areas[h] >= 0.0) continue;
            size_t owner = rings.size();
            for (size_t r = 0; r < rings.size(); ++r)
                if (areas[r] > -areas[h] && (owner == rings.size() || areas[r] < areas[owner]) &&
                    contains(rings[r], rings[h][0]))
                    owner = r;
            if (owner < rings.size()) holes[owner].push_back(h);
        }
        for (size_t r = 0; r < rings.size(); ++r) {
            if (areas[r] <= 0.0) continue;
            Loop loop = add(rings[r]);
            std::vector<Loop> inner;
            for (size_t h : holes[r]) inner.push_back(add(rings[h]));
            join_holes(loop, inner);
            cut_ears(loop);
        }
        turn_edges();
    }
    FlatMesh take() { return std::move(mesh_); }

  private:
    dvec2 at(uint32_t i) const { return mesh_.corners[i]; }

    Loop add(const Ring& ring) {
        Loop loop(ring.size());
        std::iota(loop.begin(), loop.end(), uint32_t(mesh_.corners.size()));
        mesh_.corners.insert(mesh_.corners.end(), ring.begin(), ring.end());
        return loop;
    }

    // Bridges every hole to the loop at the hole's leftmost corner (Eberly's method), holes from the left.
    void join_holes(Loop& loop, std::vector<Loop>& holes) {
        auto less = [this](uint32_t a, uint32_t b) {
            return at(a).x != at(b).x ? at(a).x < at(b).x : at(a).y != at(b).y ? at(a).y < at(b).y : a < b;
        };
        for (Loop& hole : holes)
            std::rotate(hole.begin(), std::min_element(hole.begin(), hole.end(), less), hole.end());
        std::sort(holes.begin(), holes.end(), [&](const Loop& a, const Loop& b) { return less(a[0], b[0]); });
        for (const Loop& hole : holes) {
            size_t bridge = find_bridge(loop, at(hole[0]));
            Loop joined(loop.begin(), loop.begin() + ptrdiff_t(bridge) + 1);
            joined.insert(joined.end(), hole.begin(), hole.end());
            joined.push_back(hole[0]);
            joined.insert(joined.end(), loop.begin() + ptrdiff_t(bridge), loop.end());
            loop = std::move(joined);
        }
    }

    // The place in the loop whose corner p can see, to its left.
    size_t find_bridge(const Loop& loop, dvec2 p) const {
        // The edge that the ray from p to the left meets first.
        double hit_x = -INFINITY;
        size_t best = 0;
        for (size_t i = 0; i < loop.size(); ++i) {
            size_t j = (i + 1) % loop.size();
            dvec2 a = at(loop[i]), b = at(loop[j]);
            // Inside lies to the left of an edge, so the wall on p's left side goes down.
            if (!(a.y >= p.y && b.y <= p.y) || a.y == b.y) continue;
            double x = a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y);
            if (x > p.x || x <= hit_x) continue;
            hit_x = x;
            best = a.x < b.x ? i : j;
        }
        if (hit_x == -INFINITY) return nearest(loop, p);
        // Corners in the triangle between p, the hit and the edge's end may hide it: take the one at the
        // flattest angle.
        dvec2 hit(hit_x, p.y), end = at(loop[best]);
        double flattest = INFINITY;
        size_t seen = best;
        for (size_t i = 0; i < loop.size(); ++i) {
            dvec2 q = at(loop[i]);
            if (q.x > p.x || q.x < end.x || !in_triangle(q, p, hit, end)) continue;
            if (!points_inside(loop, i, p)) continue;
            double angle = std::fabs(q.y - p.y) / std::max(p.x - q.x, 1.0e-300);
            if (angle < flattest || (angle == flattest && q.x > at(loop[seen]).x)) {
                flattest = angle;
                seen = i;
            }
        }
        return seen;
    }

    size_t nearest(const Loop& loop, dvec2 p) const {
        size_t best = 0;
        double least = INFINITY;
        for (size_t i = 0; i < loop.size(); ++i) {
            dvec2 d = at(loop[i]) - p;
            if (glm::dot(d, d) < least) least = glm::dot(d, d), best = i;
        }
        return best;
    }

    // Whether the way from corner i of the loop to p starts on the loop's inside.
    bool points_inside(const Loop& loop, size_t i, dvec2 p) const {
        dvec2 before = at(loop[(i + loop.size() - 1) % loop.size()]), here = at(loop[i]),
              after = at(loop[(i + 1) % loop.size()]);
        bool left_of_in = cross_at(before, here, p) >= 0, left_of_out = cross_at(here, after, p) >= 0;
        return cross_at(before, here, after) >= 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
    }

    static bool in_triangle(dvec2 p, dvec2 a, dvec2 b, dvec2 c) {
        double ab = cross_at(a, b, p), bc = cross_at(b, c, p), ca = cross_at(c, a, p);
        return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
    }

    bool is_ear(const std::vector<uint32_t>& next, const std::vector<uint32_t>& previous, const Loop& loop,
                uint32_t i) const {
        dvec2 a = at(loop[previous[i]]), b = at(loop[i]), c = at(loop[next[i]]);
        if (cross_at(a, b, c) <= 0.0) return false;
        dvec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        for (uint32_t j = next[next[i]]; j != previous[i]; j = next[j]) {
            dvec2 p = at(loop[j]);
            if (p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y || p == a || p == b || p == c)
                continue;
            // Only reflex corners can be in the way.
            if (cross_at(at(loop[previous[j]]), p, at(loop[next[j]])) <= 0.0 && in_triangle(p, a, b, c))
                return false;
        }
        return true;
    }

    void cut_ears(const Loop& loop) {
        uint32_t n = uint32_t(loop.size());
        std::vector<uint32_t> next(n), previous(n);
        for (uint32_t i = 0; i < n; ++i) {
            next[i] = (i + 1) % n;
            previous[i] = (i + n - 1) % n;
        }
        uint32_t i = 0, left = n, waited = 0;
        while (left > 2) {
            bool flat = cross_at(at(loop[previous[i]]), at(loop[i]), at(loop[next[i]])) == 0.0;
            // After a whole round without an ear the outline is degenerate there: cut all the same, areas
            // stay right.
            if (flat || waited > left || is_ear(next, previous, loop, i)) {
                if (!flat)
                    mesh_.indices.insert(mesh_.indices.end(), {loop[previous[i]], loop[i], loop[next[i]]});
                next[previous[i]] = next[i];
                previous[next[i]] = previous[i];
                --left;
                waited = 0;
                i = next[next[i]];  // not the neighbour: fans of thin triangles would follow
            } else {
                ++waited;
                i = next[i];
            }
        }
    }

    struct Side {
        uint32_t low, high;  // corners
        uint32_t triangle, opposite;
        bool operator<(const Side& o) const {
            return std::tie(low, high, triangle, opposite) < std::tie(o.low, o.high, o.triangle, o.opposite);
        }
    };

    // Lawson's flips, in rounds over all edges; each triangle turns at most once a round.
    void turn_edges() {
        std::vector<uint32_t>& v = mesh_.indices;
        for (int round = 0; round < 24; ++round) {
            std::vector<Side> sides;
            for (uint32_t t = 0; t < v.size() / 3; ++t)
                for (uint32_t c = 0; c < 3; ++c) {
                    uint32_t a = v[t * 3 + c], b = v[t * 3 + (c + 1) % 3];
                    sides.push_back({std::min(a, b), std::max(a, b), t, v[t * 3 + (c + 2) % 3]});
                }
            std::sort(sides.begin(), sides.end());
            std::vector<uint8_t> turned(v.size() / 3, 0);
            bool any = false;
            for (size_t s = 0; s + 1 < sides.size(); ++s) {
                const Side &one = sides[s], &two = sides[s + 1];
                if (one.low != two.low || one.high != two.high || turned[one.triangle] ||
                    turned[two.triangle])
                    continue;
                if (s + 2 < sides.size() && sides[s + 2].low == one.low && sides[s + 2].high == one.high)
                    continue;
                if (s > 0 && sides[s - 1].low == one.low && sides[s - 1].high == one.high) continue;
                if (!turn(one, two)) continue;
                turned[one.triangle] = turned[two.triangle] = 1;
                any = true;
            }
            if (!any) return;
        }
    }

    bool turn(const Side& one, const Side& two) {
        uint32_t a = one.low, b = one.high, p = one.opposite, q = two.opposite;
        if (p == q) return false;
        if (cross_at(at(a), at(b), at(p)) < 0.0) std::swap(p, q);
        // p left of a-b, q right of it; both new triangles must have area.
        double first = cross_at(at(q), at(b), at(p)), second = cross_at(at(q), at(p), at(a));
        if (cross_at(at(a), at(b), at(p)) <= 0.0 || cross_at(at(b), at(a), at(q)) <= 0.0) return false;
        double least = 1.0e-9 * (first + second);
        if (first <= least || second <= least) return false;
        if (!in_circle(at(a), at(b), at(p), at(q))) return false;
        uint32_t* t = &mesh_.indices[size_t(one.triangle) * 3];
        uint32_t* u = &mesh_.indices[size_t(two.triangle) * 3];
        t[0] = q, t[1] = b, t[2] = p;
        u[0] = q, u[1] = p, u[2] = a;
        return true;
    }

    // Whether q lies clearly inside the circle through a, b, p (counter-clockwise).
    static bool in_circle(dvec2 a, dvec2 b, dvec2 p, dvec2 q) {
        a -= q, b -= q, p -= q;
        double aa = glm::dot(a, a), bb = glm::dot(b, b), pp = glm::dot(p, p);
        double det = a.x * (b.y * pp - bb * p.y) - a.y * (b.x * pp - bb * p.x) + aa * (b.x * p.y - b.y * p.x);
        return det > 1.0e-9 * aa * std::max(bb, pp);
    }

    FlatMesh mesh_;
};

}  // namespace

FlatMesh triangulate_outline(const std::vector<Ring>& rings) { return Triangulator(rings).take(); }

}  // namespace coppice
