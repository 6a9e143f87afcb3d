#include "plugins/vegetation/cook/trace_skeleton.h"

#include <algorithm>
#include <queue>
#include "plugins/vegetation/cook/triangle_areas.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr uint32_t k_none = UINT32_MAX;
constexpr int k_cut_limit = 256;  // cuts along one component

uint32_t find_root(std::vector<uint32_t>& parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}
// The lower index stays root, so roots do not depend on the order of joining.
void join(std::vector<uint32_t>& parent, uint32_t a, uint32_t b) {
    a = find_root(parent, a);
    b = find_root(parent, b);
    if (a != b) parent[std::max(a, b)] = std::min(a, b);
}

// One connected component with its own small indices.
struct Component {
    std::vector<vec3> position;      // of its corners
    std::vector<uint32_t> corner;    // three a triangle
    std::vector<vec3> vertex_color;  // of each triangle corner, as the part gives it
    std::vector<double> area;        // of each triangle
    double total_area = 0.0;
};

struct Edge {
    uint32_t low, high;  // corners, low < high
    uint32_t triangle;
};

// What trace_component leaves: segments with their stems counted from 0, and a segment for each triangle.
struct ComponentTrace {
    std::vector<SkeletonSegment> segments;
    std::vector<uint32_t> triangle_segment;
};

vec3 mean_color(const Component& component) {
    dvec3 sum(0);
    for (size_t t = 0; t < component.area.size(); ++t)
        for (size_t k = 0; k < 3; ++k)
            sum += dvec3(component.vertex_color[3 * t + k]) * (component.area[t] / 3.0);
    return vec3(sum * (1.0 / component.total_area));
}

// The line through the centre along the longest extent. For a flat quad it runs through the middles of its
// short sides.
ComponentTrace trace_straight(const Component& component) {
    dvec3 center(0);
    for (size_t t = 0; t < component.area.size(); ++t)
        for (size_t k = 0; k < 3; ++k)
            center += dvec3(component.position[component.corner[3 * t + k]]) * (component.area[t] / 3.0);
    center *= 1.0 / component.total_area;
    // Longest axis by power iteration on the covariance of the surface: of its edges' middles, exact for
    // triangles.
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    for (size_t t = 0; t < component.area.size(); ++t) {
        for (size_t k = 0; k < 3; ++k) {
            dvec3 a(component.position[component.corner[3 * t + k]]);
            dvec3 b(component.position[component.corner[3 * t + (k + 1) % 3]]);
            dvec3 m = (a + b) * 0.5 - center;
            double w = component.area[t];
            xx += w * m.x * m.x, yy += w * m.y * m.y, zz += w * m.z * m.z;
            xy += w * m.x * m.y, xz += w * m.x * m.z, yz += w * m.y * m.z;
        }
    }
    dvec3 axis = xx >= yy && xx >= zz ? dvec3(xx, xy, xz) : yy >= zz ? dvec3(xy, yy, yz) : dvec3(xz, yz, zz);
    for (int i = 0; i < 32; ++i) {
        dvec3 turned(xx * axis.x + xy * axis.y + xz * axis.z, xy * axis.x + yy * axis.y + yz * axis.z,
                     xz * axis.x + yz * axis.y + zz * axis.z);
        double length = std::sqrt(glm::dot(turned, turned));
        if (!(length > 0.0)) break;
        axis = turned * (1.0 / length);
    }
    double axis_length = std::sqrt(glm::dot(axis, axis));
    axis = axis_length > 0.0 ? axis * (1.0 / axis_length) : dvec3(0, 1, 0);
    double low = 0.0, high = 0.0;
    for (vec3 p : component.position) {
        double along = glm::dot(dvec3(p) - center, axis);
        low = std::min(low, along);
        high = std::max(high, along);
    }
    double length = std::max(high - low, 1e-12);
    float radius = float(0.5 * component.total_area / length);  // half the width of a flat piece
    ComponentTrace trace;
    trace.segments.push_back(
        {vec3(center + axis * low), vec3(center + axis * high), radius, radius, 0, 0, mean_color(component)});
    trace.triangle_segment.assign(component.area.size(), 0);
    return trace;
}

class LevelSetTracer {
  public:
    explicit LevelSetTracer(const Component& component) : c_(component) {}

    ComponentTrace run() {
        collect_edges();
        measure_distances();
        if (!(longest_ > 0.0f)) return trace_straight(c_);
        choose_cuts();
        cut();
        link();
        ComponentTrace trace = assemble();
        return trace.segments.empty() ? trace_straight(c_) : trace;
    }

  private:
    struct Node {
        vec3 position;
        float radius_m;
        vec3 color;
    };
    struct Link {
        uint32_t parent, child;  // nodes
    };

    void collect_edges() {
        size_t triangle_count = c_.area.size();
        edges_.reserve(3 * triangle_count);
        for (uint32_t t = 0; t < triangle_count; ++t) {
            for (uint32_t k = 0; k < 3; ++k) {
                uint32_t a = c_.corner[3 * t + k], b = c_.corner[3 * t + (k + 1) % 3];
                edges_.push_back({std::min(a, b), std::max(a, b), t});
            }
        }
        std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
            return a.low != b.low     ? a.low < b.low
                   : a.high != b.high ? a.high < b.high
                                      : a.triangle < b.triangle;
        });
        first_neighbor_.assign(c_.position.size() + 1, 0);
        for (size_t i = 0; i < edges_.size(); ++i) {
            if (!starts_edge(i)) continue;
            ++first_neighbor_[edges_[i].low + 1];
            ++first_neighbor_[edges_[i].high + 1];
        }
        for (size_t v = 0; v < c_.position.size(); ++v) first_neighbor_[v + 1] += first_neighbor_[v];
        neighbors_.resize(first_neighbor_.back());
        on_border_.assign(neighbors_.size(), false);
        std::vector<uint32_t> next(first_neighbor_.begin(), first_neighbor_.end() - 1);
        for (size_t i = 0; i < edges_.size(); ++i) {
            if (!starts_edge(i)) continue;
            bool border = i + 1 == edges_.size() || starts_edge(i + 1);
            on_border_[next[edges_[i].low]] = border;
            on_border_[next[edges_[i].high]] = border;
            neighbors_[next[edges_[i].low]++] = edges_[i].high;
            neighbors_[next[edges_[i].high]++] = edges_[i].low;
        }
    }
    bool starts_edge(size_t i) const {
        return i == 0 || edges_[i].low != edges_[i - 1].low || edges_[i].high != edges_[i - 1].high;
    }

    // Shortest ways along edges.
    std::vector<float> distances_from(const std::vector<uint32_t>& sources) const {
        using Entry = std::pair<float, uint32_t>;
        std::vector<float> distance(c_.position.size(), INFINITY);
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        for (uint32_t source : sources) {
            distance[source] = 0.0f;
            queue.push({0.0f, source});
        }
        while (!queue.empty()) {
            auto [d, v] = queue.top();
            queue.pop();
            if (d > distance[v]) continue;
            for (uint32_t i = first_neighbor_[v]; i < first_neighbor_[v + 1]; ++i) {
                vec3 way = c_.position[neighbors_[i]] - c_.position[v];
                float through = d + std::sqrt(glm::dot(way, way));
                if (through < distance[neighbors_[i]]) {
                    distance[neighbors_[i]] = through;
                    queue.push({through, neighbors_[i]});
                }
            }
        }
        return distance;
    }
    static uint32_t farthest(const std::vector<float>& distance) {
        return uint32_t(std::max_element(distance.begin(), distance.end()) - distance.begin());
    }

    void measure_distances() {
        uint32_t end = farthest(distances_from({0}));
        std::vector<float> from_end = distances_from({end});
        float length = from_end[farthest(from_end)];
        // Of an open end the whole rim is the start, or every cut would be slanted: what hangs together along
        // the border within the surface's own width.
        float width = float(c_.total_area) / std::max(length, 1e-12f);
        std::vector<uint32_t> sources{end};
        std::vector<bool> taken(c_.position.size(), false);
        taken[end] = true;
        for (size_t s = 0; s < sources.size(); ++s) {
            for (uint32_t i = first_neighbor_[sources[s]]; i < first_neighbor_[sources[s] + 1]; ++i) {
                uint32_t v = neighbors_[i];
                vec3 away = c_.position[v] - c_.position[end];
                if (!on_border_[i] || taken[v] || glm::dot(away, away) > 1.21f * width * width) continue;
                taken[v] = true;
                sources.push_back(v);
            }
        }
        distance_ = sources.size() > 1 ? distances_from(sources) : std::move(from_end);
        longest_ = distance_[farthest(distance_)];
        width_ = float(c_.total_area) /
                 (k_pi * std::max(longest_, 1e-12f));  // diameter of a tube of this area and length
    }

    // Cuts run through the rings of corners where there are rings, so that each triangle of a tube lies
    // between two cuts; where corners lie at all distances, they follow each other at the tube's own width.
    void choose_cuts() {
        slack_ = 0.5f * width_;
        std::vector<float> sorted = distance_;
        std::sort(sorted.begin(), sorted.end());
        for (size_t first = 0, last; first < sorted.size(); first = last) {
            double sum = 0.0;
            for (last = first;
                 last < sorted.size() && (last == first || sorted[last] - sorted[last - 1] < slack_); ++last)
                sum += double(sorted[last]);
            float extent = sorted[last - 1] - sorted[first];
            if (extent > 1.5f * width_) {
                int count = std::clamp(int(extent / width_ + 0.5f), 1, k_cut_limit);
                for (int i = 0; i < count; ++i)
                    cuts_.push_back(sorted[first] + extent * ((float(i) + 0.5f) / float(count)));
            } else if (first > 0 && last < sorted.size()) {
                cuts_.push_back(float(sum / double(last - first)));
            }
        }
        if (cuts_.size() > size_t(k_cut_limit)) {
            cuts_.clear();
            for (int i = 1; i <= k_cut_limit; ++i)
                cuts_.push_back(longest_ * float(i) / float(k_cut_limit + 1));
        }
    }

    // Band b holds the surface between cuts b and b + 1; cuts count from 1.
    void cut() {
        band_.resize(distance_.size());
        for (size_t v = 0; v < band_.size(); ++v) band_[v] = band_at(distance_[v]);

        size_t triangle_count = c_.area.size();
        first_piece_.assign(triangle_count + 1, 0);
        lowest_.resize(triangle_count);
        for (size_t t = 0; t < triangle_count; ++t) {
            int a = band_[c_.corner[3 * t]], b = band_[c_.corner[3 * t + 1]], d = band_[c_.corner[3 * t + 2]];
            lowest_[t] = std::min({a, b, d});
            first_piece_[t + 1] = first_piece_[t] + uint32_t(std::max({a, b, d}) - lowest_[t] + 1);
        }
        piece_parent_.resize(first_piece_.back());
        crossing_parent_.resize(
            first_piece_.back());  // of triangle t and cut j: the slot of its piece above, band j
        for (uint32_t i = 0; i < piece_parent_.size(); ++i) piece_parent_[i] = crossing_parent_[i] = i;
        for (size_t i = 1; i < edges_.size(); ++i) {
            if (starts_edge(i)) continue;
            uint32_t t = edges_[i - 1].triangle, u = edges_[i].triangle;
            int low = std::min(band_[edges_[i].low], band_[edges_[i].high]);
            int high = std::max(band_[edges_[i].low], band_[edges_[i].high]);
            for (int b = low; b <= high; ++b) {
                join(piece_parent_, piece_of(t, b), piece_of(u, b));
                if (b > low) join(crossing_parent_, piece_of(t, b), piece_of(u, b));
            }
        }
    }
    int band_at(float distance) const {
        return int(std::upper_bound(cuts_.begin(), cuts_.end(), distance) - cuts_.begin());
    }
    uint32_t piece_of(uint32_t triangle, int band) const {
        return first_piece_[triangle] + uint32_t(band - lowest_[triangle]);
    }
    int bands_of(uint32_t triangle) const { return int(first_piece_[triangle + 1] - first_piece_[triangle]); }

    // Ends of the line in which cut j meets the triangle.
    void cross(uint32_t t, int j, vec3 end[2]) const {
        int found = 0;
        for (uint32_t k = 0; k < 3 && found < 2; ++k) {
            uint32_t a = c_.corner[3 * t + k], b = c_.corner[3 * t + (k + 1) % 3];
            if (std::min(band_[a], band_[b]) >= j || std::max(band_[a], band_[b]) < j) continue;
            if (a > b) std::swap(a, b);  // both triangles of an edge get the same bits
            float rise = distance_[b] - distance_[a];
            float share = std::fabs(rise) > 0.0f ? (cuts_[size_t(j) - 1] - distance_[a]) / rise : 0.5f;
            end[found++] = c_.position[a] + (c_.position[b] - c_.position[a]) * std::clamp(share, 0.0f, 1.0f);
        }
        if (found == 1) end[1] = end[0];
        if (found == 0) end[0] = end[1] = c_.position[c_.corner[3 * t]];
    }

    void link() {
        size_t slot_count = piece_parent_.size();
        std::vector<uint32_t> node_of(slot_count, k_none);  // by root crossing
        std::vector<double> weight;
        std::vector<dvec3> position, color;
        std::vector<double> radius;
        auto for_each_crossing = [&](auto&& visit) {
            for (uint32_t t = 0; t < c_.area.size(); ++t)
                for (int j = lowest_[t] + 1; j < lowest_[t] + bands_of(t); ++j) {
                    vec3 end[2];
                    cross(t, j, end);
                    // Never zero: a cut that only touches corners still has a centre.
                    double w = double(std::sqrt(glm::dot(end[1] - end[0], end[1] - end[0]))) + 1e-12;
                    visit(t, j, find_root(crossing_parent_, piece_of(t, j)), end, w);
                }
        };
        for_each_crossing([&](uint32_t t, int, uint32_t root, const vec3 end[2], double w) {
            if (node_of[root] == k_none) {
                node_of[root] = uint32_t(weight.size());
                weight.push_back(0.0);
                position.emplace_back(0.0);
                color.emplace_back(0.0);
                radius.push_back(0.0);
            }
            uint32_t n = node_of[root];
            weight[n] += w;
            position[n] += (dvec3(end[0]) + dvec3(end[1])) * (0.5 * w);
            for (uint32_t k = 0; k < 3; ++k) color[n] += dvec3(c_.vertex_color[3 * t + k]) * (w / 3.0);
        });
        for (size_t n = 0; n < weight.size(); ++n)
            nodes_.push_back(
                {vec3(position[n] * (1.0 / weight[n])), 0.0f, vec3(color[n] * (1.0 / weight[n]))});
        // Which cuts bound which piece of surface.
        struct Bound {
            uint32_t piece, upper, node;
            auto operator<=>(const Bound&) const = default;
        };
        std::vector<Bound> bounds;
        for_each_crossing([&](uint32_t t, int j, uint32_t root, const vec3 end[2], double w) {
            uint32_t n = node_of[root];
            for (int side = 0; side < 2; ++side) {
                vec3 out = end[side] - nodes_[n].position;
                radius[n] += 0.5 * w * double(std::sqrt(glm::dot(out, out)));
            }
            bounds.push_back({find_root(piece_parent_, piece_of(t, j - 1)), 1, n});
            bounds.push_back({find_root(piece_parent_, piece_of(t, j)), 0, n});
        });
        for (size_t n = 0; n < weight.size(); ++n) nodes_[n].radius_m = float(radius[n] / weight[n]);
        std::sort(bounds.begin(), bounds.end());
        bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());

        // Ends of pieces bounded on one side only: the mean of their outermost corners.
        std::vector<float> reach(slot_count, -INFINITY), depth(slot_count, INFINITY);
        for_each_corner([&](uint32_t piece, uint32_t v) {
            reach[piece] = std::max(reach[piece], distance_[v]);
            depth[piece] = std::min(depth[piece], distance_[v]);
        });
        std::vector<dvec3> top(slot_count, dvec3(0)), bottom(slot_count, dvec3(0));
        std::vector<uint32_t> top_count(slot_count, 0), bottom_count(slot_count, 0);
        for_each_corner([&](uint32_t piece, uint32_t v) {
            if (distance_[v] >= reach[piece] - slack_) {
                top[piece] += dvec3(c_.position[v]);
                ++top_count[piece];
            }
            if (distance_[v] <= depth[piece] + slack_) {
                bottom[piece] += dvec3(c_.position[v]);
                ++bottom_count[piece];
            }
        });

        piece_first_link_.assign(slot_count, k_none);
        piece_link_count_.assign(slot_count, 0);
        for (size_t first = 0, last; first < bounds.size(); first = last) {
            uint32_t piece = bounds[first].piece;
            std::vector<uint32_t> lower, upper;
            for (last = first; last < bounds.size() && bounds[last].piece == piece; ++last)
                (bounds[last].upper ? upper : lower).push_back(bounds[last].node);
            piece_first_link_[piece] = uint32_t(links_.size());
            if (lower.empty() || upper.empty()) {
                bool tip = upper.empty();
                uint32_t count = tip ? top_count[piece] : bottom_count[piece];
                const Node& cut = nodes_[tip ? lower[0] : upper[0]];
                vec3 at = count ? vec3((tip ? top[piece] : bottom[piece]) * (1.0 / count)) : cut.position;
                vec3 out = at - cut.position;
                // A bump on the side of a stem is no branch.
                if (glm::dot(out, out) > 0.25f * cut.radius_m * cut.radius_m) {
                    nodes_.push_back({at, cut.radius_m, cut.color});
                    uint32_t end = uint32_t(nodes_.size() - 1);
                    for (uint32_t n : tip ? lower : upper)
                        links_.push_back(tip ? Link{n, end} : Link{end, n});
                }
            } else {
                auto nearest = [&](uint32_t n, const std::vector<uint32_t>& others) {
                    uint32_t best = others[0];
                    float best_square = INFINITY;
                    for (uint32_t other : others) {
                        vec3 way = nodes_[other].position - nodes_[n].position;
                        if (glm::dot(way, way) < best_square) {
                            best_square = glm::dot(way, way);
                            best = other;
                        }
                    }
                    return best;
                };
                std::vector<uint32_t> used;
                for (uint32_t n : upper) {
                    links_.push_back({nearest(n, lower), n});
                    used.push_back(links_.back().parent);
                }
                for (uint32_t n : lower)
                    if (std::find(used.begin(), used.end(), n) == used.end())
                        links_.push_back({n, nearest(n, upper)});
            }
            piece_link_count_[piece] = uint32_t(links_.size()) - piece_first_link_[piece];
            if (piece_link_count_[piece] == 0) piece_bump_node_.push_back({piece, bounds[first].node});
        }
    }
    template <class Visit>
    void for_each_corner(Visit&& visit) {
        for (uint32_t t = 0; t < c_.area.size(); ++t)
            for (uint32_t k = 0; k < 3; ++k) {
                uint32_t v = c_.corner[3 * t + k];
                visit(find_root(piece_parent_, piece_of(t, band_[v])), v);
            }
    }

    // Stems: from each node the thickest child goes on, the others begin stems of their own.
    ComponentTrace assemble() {
        std::vector<uint32_t> onward(nodes_.size(), k_none);    // link
        std::vector<uint32_t> arriving(nodes_.size(), k_none);  // the first link that leads to the node
        for (uint32_t i = 0; i < links_.size(); ++i) {
            uint32_t& best = onward[links_[i].parent];
            if (best == k_none || nodes_[links_[i].child].radius_m > nodes_[links_[best].child].radius_m)
                best = i;
            if (arriving[links_[i].child] == k_none) arriving[links_[i].child] = i;
        }
        ComponentTrace trace;
        std::vector<uint32_t> segment_of_link(links_.size(), k_none);
        uint32_t stem = 0;
        for (uint32_t i = 0; i < links_.size(); ++i) {
            bool continues = onward[links_[i].parent] == i && arriving[links_[i].parent] != k_none;
            if (continues) continue;
            for (uint32_t at = i; at != k_none && segment_of_link[at] == k_none;) {
                const Node &from = nodes_[links_[at].parent], &to = nodes_[links_[at].child];
                segment_of_link[at] = uint32_t(trace.segments.size());
                trace.segments.push_back({from.position, to.position, from.radius_m, to.radius_m, stem, 0,
                                          (from.color + to.color) * 0.5f});
                at = arriving[links_[at].child] == at ? onward[links_[at].child] : k_none;
            }
            ++stem;
        }
        std::vector<uint32_t> bump_link(piece_parent_.size(), k_none);
        for (auto [piece, node] : piece_bump_node_)
            bump_link[piece] = arriving[node] != k_none ? arriving[node] : onward[node];
        trace.triangle_segment.resize(c_.area.size(), 0);
        for (uint32_t t = 0; t < c_.area.size() && !trace.segments.empty(); ++t) {
            vec3 middle = (c_.position[c_.corner[3 * t]] + c_.position[c_.corner[3 * t + 1]] +
                           c_.position[c_.corner[3 * t + 2]]) *
                          (1.0f / 3.0f);
            float mean_distance = (distance_[c_.corner[3 * t]] + distance_[c_.corner[3 * t + 1]] +
                                   distance_[c_.corner[3 * t + 2]]) *
                                  (1.0f / 3.0f);
            int band = std::clamp(band_at(mean_distance), lowest_[t], lowest_[t] + bands_of(t) - 1);
            uint32_t piece = find_root(piece_parent_, piece_of(t, band));
            uint32_t best = bump_link[piece];
            float best_distance = INFINITY;
            for (uint32_t i = 0; i < piece_link_count_[piece]; ++i) {
                uint32_t l = piece_first_link_[piece] + i;
                float d = distance_to_segment(middle, nodes_[links_[l].parent].position,
                                              nodes_[links_[l].child].position);
                if (d < best_distance) {
                    best_distance = d;
                    best = l;
                }
            }
            trace.triangle_segment[t] = best == k_none ? 0 : segment_of_link[best];
        }
        return trace;
    }

    const Component& c_;
    std::vector<Edge> edges_;  // every edge once a triangle, the same ones together
    std::vector<uint32_t> first_neighbor_, neighbors_;
    std::vector<bool> on_border_;  // of each neighbour: the edge to it belongs to one triangle only
    std::vector<float> distance_;  // over the surface from one end, of each corner
    float longest_ = 0.0f, width_ = 0.0f, slack_ = 0.0f;
    std::vector<float> cuts_;            // distances, rising
    std::vector<int> band_;              // of each corner
    std::vector<int> lowest_;            // band of each triangle's lowest corner
    std::vector<uint32_t> first_piece_;  // slot of each triangle's piece in its lowest band
    std::vector<uint32_t> piece_parent_, crossing_parent_;
    std::vector<Node> nodes_;
    std::vector<Link> links_;
    std::vector<uint32_t> piece_first_link_, piece_link_count_;
    std::vector<std::pair<uint32_t, uint32_t>> piece_bump_node_;
};

// A segment without length has no direction: it is taken out, and its triangles go to its neighbour on the
// stem.
void drop_short_segments(ComponentTrace& trace) {
    std::vector<uint32_t> new_index(trace.segments.size());
    std::vector<SkeletonSegment> kept;
    for (size_t i = 0; i < trace.segments.size(); ++i) {
        new_index[i] = uint32_t(kept.size());
        if (trace.segments[i].begin_plant != trace.segments[i].end_plant) kept.push_back(trace.segments[i]);
    }
    if (kept.size() == trace.segments.size()) return;
    for (uint32_t& segment : trace.triangle_segment)
        segment = std::min(new_index[segment], uint32_t(std::max<size_t>(kept.size(), 1) - 1));
    trace.segments = std::move(kept);
}

ComponentTrace trace_component(const Component& component) {
    ComponentTrace trace =
        component.area.size() <= 2 ? trace_straight(component) : LevelSetTracer(component).run();
    drop_short_segments(trace);
    return trace.segments.empty() ? trace_straight(component) : trace;
}

}  // namespace

float distance_to_segment(vec3 p, vec3 a, vec3 b) {
    vec3 along = b - a;
    float square = glm::dot(along, along);
    float share = square > 0.0f ? std::clamp(glm::dot(p - a, along) / square, 0.0f, 1.0f) : 0.0f;
    vec3 away = p - (a + along * share);
    return std::sqrt(glm::dot(away, away));
}

TracedSkeleton trace_skeleton(const PartDescription& part, const std::vector<uint32_t>& welded) {
    uint32_t triangle_count = uint32_t(part.indices.size() / 3);
    std::vector<double> areas = triangle_areas(part);
    std::vector<uint32_t> parent(part.vertices.size());
    for (uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
    for (size_t i = 0; i < part.indices.size(); i += 3) {
        join(parent, welded[part.indices[i]], welded[part.indices[i + 1]]);
        join(parent, welded[part.indices[i]], welded[part.indices[i + 2]]);
    }
    // Triangles grouped by component, components in the order of their first triangle.
    std::vector<uint32_t> component_of_root(part.vertices.size(), k_none), component_of(triangle_count),
        first{0};
    for (uint32_t t = 0; t < triangle_count; ++t) {
        uint32_t& c = component_of_root[find_root(parent, welded[part.indices[3 * size_t(t)]])];
        if (c == k_none) {
            c = uint32_t(first.size() - 1);
            first.push_back(0);
        }
        component_of[t] = c;
        ++first[c + 1];
    }
    for (size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
    std::vector<uint32_t> grouped(triangle_count), next(first.begin(), first.end() - 1);
    for (uint32_t t = 0; t < triangle_count; ++t) grouped[next[component_of[t]]++] = t;

    size_t component_count = first.size() - 1;
    std::vector<ComponentTrace> traces(component_count);
    std::vector<uint32_t> local(part.vertices.size(), k_none);  // a corner belongs to one component only
    parallel_for(component_count, 64, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            Component component;
            for (uint32_t i = first[c]; i < first[c + 1]; ++i) {
                uint32_t t = grouped[i];
                for (size_t k = 0; k < 3; ++k) {
                    uint32_t vertex = part.indices[3 * size_t(t) + k], corner = welded[vertex];
                    if (local[corner] == k_none) {
                        local[corner] = uint32_t(component.position.size());
                        component.position.push_back(part.vertices[corner].position_plant);
                    }
                    component.corner.push_back(local[corner]);
                    component.vertex_color.push_back(part.vertices[vertex].color_linear);
                }
                component.area.push_back(areas[t]);
                component.total_area += areas[t];
            }
            traces[c] = trace_component(component);
        }
    });

    TracedSkeleton skeleton;
    skeleton.triangle_segment.resize(triangle_count);
    uint32_t stem = 0;
    for (size_t c = 0; c < component_count; ++c) {
        uint32_t first_segment = uint32_t(skeleton.segments.size()), stem_count = 0;
        for (SkeletonSegment segment : traces[c].segments) {
            stem_count = std::max(stem_count, segment.stem + 1);
            segment.stem += stem;
            skeleton.segments.push_back(segment);
        }
        stem += stem_count;
        for (uint32_t i = first[c]; i < first[c + 1]; ++i)
            skeleton.triangle_segment[grouped[i]] = first_segment + traces[c].triangle_segment[i - first[c]];
    }
    return skeleton;
}

TracedSkeleton adopt_skeleton(const PartDescription& part) {
    TracedSkeleton skeleton;
    skeleton.segments = part.skeleton;
    const auto& segments = skeleton.segments;
    Box box;
    for (const SkeletonSegment& s : segments) {
        vec3 radius(std::max(s.begin_radius_m, s.end_radius_m));
        box.include(glm::min(s.begin_plant, s.end_plant) - radius);
        box.include(glm::max(s.begin_plant, s.end_plant) + radius);
    }
    // A grid over the segments' boxes, each grown by half its radius: a triangle on a stem's surface finds it
    // in the cell of its own centre.
    vec3 size = box.size();
    float extent = std::max({size.x, size.y, size.z, 1e-6f}) * 1.001f;
    size_t side = 48;
    auto cell_of = [&](vec3 p, int axis) {
        return size_t(std::clamp((p[axis] - box.min[axis]) / extent, 0.0f, 0.9999f) * float(side));
    };
    auto for_each_cell = [&](const SkeletonSegment& s, auto&& visit) {
        vec3 margin(1.5f * std::max(s.begin_radius_m, s.end_radius_m) + 0.01f * extent / float(side));
        vec3 low = glm::min(s.begin_plant, s.end_plant) - margin,
             high = glm::max(s.begin_plant, s.end_plant) + margin;
        for (size_t z = cell_of(low, 2); z <= cell_of(high, 2); ++z)
            for (size_t y = cell_of(low, 1); y <= cell_of(high, 1); ++y)
                for (size_t x = cell_of(low, 0); x <= cell_of(high, 0); ++x) visit((z * side + y) * side + x);
    };
    // Long or thick segments fill many cells: a coarser grid then, so that memory stays in proportion to the
    // part.
    std::vector<uint32_t> first;
    for (;; side /= 2) {
        size_t entry_count = 0, entry_limit = 64 * segments.size() + (1u << 20);
        first.assign(side * side * side + 1, 0);
        for (size_t i = 0; i < segments.size() && entry_count <= entry_limit; ++i)
            for_each_cell(segments[i], [&](size_t c) {
                ++first[c + 1];
                ++entry_count;
            });
        if (entry_count <= entry_limit || side == 1) break;
    }
    for (size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
    std::vector<uint32_t> inside(first.back()), next(first.begin(), first.end() - 1);
    for (uint32_t i = 0; i < segments.size(); ++i)
        for_each_cell(segments[i], [&](size_t c) { inside[next[c]++] = i; });

    skeleton.triangle_segment.resize(part.indices.size() / 3);
    parallel_for(skeleton.triangle_segment.size(), 1 << 10, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            vec3 middle(0);
            for (size_t k = 0; k < 3; ++k)
                middle += part.vertices[part.indices[3 * t + k]].position_plant * (1.0f / 3.0f);
            float best_off = INFINITY;
            uint32_t best = 0;
            // All three corners must fit: where twigs cross, one place alone lies on several surfaces.
            auto consider = [&](uint32_t i) {
                const SkeletonSegment& s = segments[i];
                vec3 along = s.end_plant - s.begin_plant;
                float square = glm::dot(along, along), off = 0.0f;
                for (size_t k = 0; k < 3; ++k) {
                    vec3 p = part.vertices[part.indices[3 * t + k]].position_plant - s.begin_plant;
                    float share = square > 0.0f ? std::clamp(glm::dot(p, along) / square, 0.0f, 1.0f) : 0.0f;
                    vec3 away = p - along * share;
                    float radius = s.begin_radius_m + (s.end_radius_m - s.begin_radius_m) * share;
                    off = std::max(off, std::fabs(std::sqrt(glm::dot(away, away)) - radius));
                }
                if (off < best_off) {
                    best_off = off;
                    best = i;
                }
            };
            size_t c = (cell_of(middle, 2) * side + cell_of(middle, 1)) * side + cell_of(middle, 0);
            for (uint32_t i = first[c]; i < first[c + 1]; ++i) consider(inside[i]);
            if (best_off == INFINITY)
                for (uint32_t i = 0; i < segments.size(); ++i) consider(i);
            skeleton.triangle_segment[t] = best;
        }
    });
    return skeleton;
}

}  // namespace coppice
