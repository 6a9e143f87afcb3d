#include "plugins/vegetation/cook/import/alpha_cut.h"

#include <algorithm>
#include <array>
#include <map>
#include "plugins/vegetation/cook/import/average_colors.h"
#include "plugins/vegetation/cook/import/simplify_outline.h"
#include "plugins/vegetation/cook/import/texture_pyramid.h"
#include "plugins/vegetation/cook/import/trace_outline.h"
#include "plugins/vegetation/cook/import/triangulate_outline.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr int64_t k_tile_limit = 16;      // repeats of a texture on one triangle that are cut
constexpr size_t k_least_corners = 8;     // of a window, whatever the target
constexpr size_t k_most_corners = 8'192;  // the same; cutting ears takes the square of it
constexpr size_t k_most_traced =
    200'000;                           // corners traced; a finer picture than that is noise, and is averaged
constexpr double k_uv_slack = 1.0e-4;  // coordinates meant to end at a texture's border may miss it by this
constexpr double k_key_steps = 65536.0;  // regions are the same where their coordinates agree to 1 / this

// Whole repeats of the texture: [first, first + count) in both directions.
struct Window {
    int64_t first_u, first_v, count_u, count_v;
    auto operator<=>(const Window&) const = default;
};

// What is opaque in a window, in texture coordinates.
struct WindowMesh {
    std::vector<dvec2> uvs;
    std::vector<vec3> colors;
    std::vector<uint32_t> indices;
};

// One triangle, or two that lie flat in one plane and map alike: corners 0 to 2 are the first one's.
struct Region {
    std::array<uint32_t, 3> vertices;
    std::array<dvec2, 4> uvs;    // counter-clockwise or clockwise as in the texture
    std::array<int, 4> outline;  // order of uvs round the region
    int corner_count;
    uint32_t element;
    Window window;
    double uv_area() const {
        double twice = 0.0;
        for (int i = 2; i < corner_count; ++i)
            twice += cross_at(uvs[size_t(outline[0])], uvs[size_t(outline[size_t(i - 1)])],
                              uvs[size_t(outline[size_t(i)])]);
        return std::fabs(twice) * 0.5;
    }
};

// How much the mesh shows of a window.
struct WindowUse {
    double uv_area = 0.0;
    size_t triangles = 0;
};

// A window's mesh clipped to a region, in weights of the region's vertices 1 and 2.
struct Cut {
    std::vector<dvec2> weights;
    std::vector<vec3> colors;
    std::vector<uint32_t> indices;
};

struct ClippedCorner {
    dvec2 uv;
    vec3 color;
};

// Finds the repeats of the texture that the region shows, and moves the region to the first that look alike.
void move_to_window(Region& region, GltfWrap wrap_s, GltfWrap wrap_t) {
    dvec2 low = region.uvs[0], high = low;
    for (int i = 1; i < region.corner_count; ++i) {
        low = glm::min(low, region.uvs[size_t(i)]);
        high = glm::max(high, region.uvs[size_t(i)]);
    }
    auto along = [](double least, double most, GltfWrap wrap, int64_t& first, int64_t& count) {
        first = int64_t(std::floor(least + k_uv_slack));
        count = std::max<int64_t>(int64_t(std::ceil(most - k_uv_slack)) - first, 1);
        int64_t period = wrap == GltfWrap::repeat ? 1 : wrap == GltfWrap::mirror ? 2 : 0;
        int64_t moved = period ? first - ((first % period) + period) % period : 0;
        first -= moved;
        return double(moved);
    };
    dvec2 shift;
    shift.x = along(low.x, high.x, wrap_s, region.window.first_u, region.window.count_u);
    shift.y = along(low.y, high.y, wrap_t, region.window.first_v, region.window.count_v);
    for (int i = 0; i < region.corner_count; ++i) region.uvs[size_t(i)] -= shift;
}

class Cutter {
  public:
    Cutter(const ImportMesh& mesh, const Picture& picture, GltfWrap wrap_s, GltfWrap wrap_t,
           float opaque_alpha, const AlphaCutSettings& settings)
        : mesh_(mesh),
          picture_(picture),
          wrap_s_(wrap_s),
          wrap_t_(wrap_t),
          opaque_alpha_(opaque_alpha),
          settings_(settings),
          texture_(picture, wrap_s, wrap_t, uint32_t(std::ceil(opaque_alpha))) {}

    ImportMesh run() {
        out_.element_count = mesh_.element_count;
        std::vector<Region> regions;
        for (size_t t = 0; t < mesh_.triangle_count();) {
            Region region = triangle_region(t);
            size_t triangles = t + 1 < mesh_.triangle_count() && add_partner(region, t + 1) ? 2 : 1;
            move_to_window(region, wrap_s_, wrap_t_);
            WindowUse& use = uses_[region.window];
            use.uv_area += region.uv_area();
            use.triangles += triangles;
            t += triangles;
            regions.push_back(region);
        }
        for (const Region& region : regions) emit(region);
        return std::move(out_);
    }

  private:
    Region triangle_region(size_t t) const {
        Region region{{}, {}, {0, 1, 2, 3}, 3, mesh_.elements[t], {}};
        for (size_t c = 0; c < 3; ++c) {
            region.vertices[c] = mesh_.indices[t * 3 + c];
            region.uvs[c] = dvec2(mesh_.uvs[region.vertices[c]]);
        }
        return region;
    }

    bool same_vertex(uint32_t a, uint32_t b) const {
        return a == b ||
               (mesh_.positions_plant[a] == mesh_.positions_plant[b] && mesh_.uvs[a] == mesh_.uvs[b]);
    }

    static dvec2 weights_of(const Region& region, dvec2 uv) {
        double area = cross_at(region.uvs[0], region.uvs[1], region.uvs[2]);
        return dvec2(cross_at(region.uvs[0], uv, region.uvs[2]), cross_at(region.uvs[0], region.uvs[1], uv)) /
               area;
    }

    template <class Value>
    Value blend(const std::vector<Value>& values, const Region& region, dvec2 w) const {
        Value a = values[region.vertices[0]];
        return a + (values[region.vertices[1]] - a) * float(w.x) +
               (values[region.vertices[2]] - a) * float(w.y);
    }

    // Two halves of a flat card are cut as one, so that no needless edge runs through the leaf.
    bool add_partner(Region& region, size_t t) const {
        const uint32_t* other = &mesh_.indices[t * 3];
        if (mesh_.elements[t] != mesh_.elements[t - 1]) return false;
        int unmatched = -1, matches = 0;
        std::array<bool, 3> shared{};
        for (int o = 0; o < 3; ++o) {
            bool found = false;
            for (size_t c = 0; c < 3; ++c)
                if (same_vertex(other[o], region.vertices[c])) shared[c] = found = true;
            found ? ++matches : unmatched = o;
        }
        if (matches != 2 || shared[0] + shared[1] + shared[2] != 2) return false;
        if (cross_at(region.uvs[0], region.uvs[1], region.uvs[2]) == 0.0) return false;
        uint32_t fourth = other[unmatched];
        dvec2 uv(mesh_.uvs[fourth]), w = weights_of(region, uv);
        vec3 p0 = mesh_.positions_plant[region.vertices[0]], p1 = mesh_.positions_plant[region.vertices[1]];
        vec3 expected = blend(mesh_.positions_plant, region, w);
        float size = glm::length(p1 - p0) + glm::length(mesh_.positions_plant[region.vertices[2]] - p0);
        if (!(glm::length(expected - mesh_.positions_plant[fourth]) < 1.0e-3f * size)) return false;
        if (!(glm::length(blend(mesh_.normals_plant, region, w) - mesh_.normals_plant[fourth]) < 0.05f))
            return false;
        if (!(glm::length(blend(mesh_.colors_linear, region, w) - mesh_.colors_linear[fourth]) < 0.02f))
            return false;
        // The fourth corner stands across the shared edge, between its two ends.
        int apart = !shared[0] ? 0 : !shared[1] ? 1 : 2;
        region.uvs[3] = uv;
        region.outline = {apart, (apart + 1) % 3, 3, (apart + 2) % 3};
        region.corner_count = 4;
        double turn = cross_at(region.uvs[0], region.uvs[1], region.uvs[2]);
        for (size_t i = 0; i < 4; ++i) {
            double corner = cross_at(region.uvs[size_t(region.outline[i])],
                                     region.uvs[size_t(region.outline[(i + 1) % 4])],
                                     region.uvs[size_t(region.outline[(i + 2) % 4])]);
            if (corner * turn <= 0.0) {  // not convex
                region.outline = {0, 1, 2, 3};
                region.corner_count = 3;
                return false;
            }
        }
        return true;
    }

    void emit(const Region& region) {
        const Window& window = region.window;
        bool flat = region.uv_area() < 1.0e-14;
        if (flat || window.count_u > k_tile_limit || window.count_v > k_tile_limit ||
            window.count_u * window.count_v > k_tile_limit) {
            vec2 middle((region.uvs[0] + region.uvs[1] + region.uvs[2]) / 3.0);
            if (flat && texture_.texel(middle, 0).w == 0.0f) return;
            emit_whole(region, texture_.nearest_color(middle));
            return;
        }
        std::vector<int64_t> key{window.first_u, window.first_v, window.count_u, window.count_v};
        for (int i = 0; i < region.corner_count; ++i) {
            key.push_back(int64_t(std::floor(region.uvs[size_t(i)].x * k_key_steps + 0.5)));
            key.push_back(int64_t(std::floor(region.uvs[size_t(i)].y * k_key_steps + 0.5)));
        }
        auto found = cuts_.find(key);
        if (found == cuts_.end()) found = cuts_.emplace(std::move(key), cut_region(region)).first;
        const Cut& cut = found->second;
        uint32_t first = uint32_t(out_.positions_plant.size());
        for (size_t i = 0; i < cut.weights.size(); ++i) {
            out_.positions_plant.push_back(blend(mesh_.positions_plant, region, cut.weights[i]));
            vec3 normal = mesh_.normals_plant[region.vertices[0]];
            out_.normals_plant.push_back(
                normalize_or(blend(mesh_.normals_plant, region, cut.weights[i]), normal));
            out_.colors_linear.push_back(blend(mesh_.colors_linear, region, cut.weights[i]) * cut.colors[i]);
        }
        for (uint32_t index : cut.indices) out_.indices.push_back(first + index);
        out_.elements.insert(out_.elements.end(), cut.indices.size() / 3, region.element);
    }

    void emit_whole(const Region& region, vec3 color) {
        uint32_t first = uint32_t(out_.positions_plant.size());
        for (uint32_t v : region.vertices) {
            out_.positions_plant.push_back(mesh_.positions_plant[v]);
            out_.normals_plant.push_back(mesh_.normals_plant[v]);
            out_.colors_linear.push_back(mesh_.colors_linear[v] * color);
        }
        out_.indices.insert(out_.indices.end(), {first, first + 1, first + 2});
        out_.elements.push_back(region.element);
    }

    // Clips the window's triangles to the region, edge by edge.
    Cut cut_region(const Region& region) {
        const WindowMesh& source = window_mesh(region.window);
        bool clockwise = cross_at(region.uvs[0], region.uvs[1], region.uvs[2]) < 0.0;
        std::array<dvec2, 4> outline{};
        size_t n = size_t(region.corner_count);
        for (size_t i = 0; i < n; ++i)
            outline[i] = region.uvs[size_t(region.outline[clockwise ? n - 1 - i : i])];
        dvec2 low = outline[0], high = outline[0];
        for (size_t i = 1; i < n; ++i) low = glm::min(low, outline[i]), high = glm::max(high, outline[i]);
        double least_area = 1.0e-9 * std::fabs(cross_at(region.uvs[0], region.uvs[1], region.uvs[2]));

        std::vector<ClippedCorner> corners;
        std::vector<ClippedCorner> polygon, clipped;
        for (size_t t = 0; t < source.indices.size(); t += 3) {
            polygon.clear();
            dvec2 from(INFINITY), to(-INFINITY);
            for (size_t c = 0; c < 3; ++c) {
                uint32_t v = source.indices[t + c];
                polygon.push_back({source.uvs[v], source.colors[v]});
                from = glm::min(from, source.uvs[v]);
                to = glm::max(to, source.uvs[v]);
            }
            if (from.x >= high.x || from.y >= high.y || to.x <= low.x || to.y <= low.y) continue;
            for (size_t e = 0; e < n && !polygon.empty(); ++e) {
                dvec2 a = outline[e], b = outline[(e + 1) % n];
                clipped.clear();
                for (size_t i = 0; i < polygon.size(); ++i) {
                    const ClippedCorner &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
                    double p_side = cross_at(a, b, p.uv), q_side = cross_at(a, b, q.uv);
                    if (p_side >= 0.0) clipped.push_back(p);
                    if ((p_side > 0.0 && q_side < 0.0) || (p_side < 0.0 && q_side > 0.0)) {
                        double s = p_side / (p_side - q_side);
                        clipped.push_back(
                            {p.uv + (q.uv - p.uv) * s, p.color + (q.color - p.color) * float(s)});
                    }
                }
                polygon.swap(clipped);
            }
            for (size_t i = 2; i < polygon.size(); ++i)
                if (cross_at(polygon[0].uv, polygon[i - 1].uv, polygon[i].uv) > least_area)
                    for (size_t corner : {size_t(0), clockwise ? i : i - 1, clockwise ? i - 1 : i})
                        corners.push_back(polygon[corner]);
        }
        return share_corners(region, corners);
    }

    static Cut share_corners(const Region& region, const std::vector<ClippedCorner>& corners) {
        std::vector<uint32_t> order(corners.size());
        for (size_t i = 0; i < order.size(); ++i) order[i] = uint32_t(i);
        std::sort(order.begin(), order.end(), [&corners](uint32_t a, uint32_t b) {
            dvec2 p = corners[a].uv, q = corners[b].uv;
            return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : a < b;
        });
        Cut cut;
        cut.indices.resize(corners.size());
        for (size_t i = 0; i < order.size(); ++i) {
            const ClippedCorner& corner = corners[order[i]];
            if (i == 0 || corners[order[i - 1]].uv != corner.uv) {
                cut.weights.push_back(weights_of(region, corner.uv));
                cut.colors.push_back(corner.color);
            }
            cut.indices[order[i]] = uint32_t(cut.weights.size() - 1);
        }
        return cut;
    }

    const WindowMesh& window_mesh(const Window& window) {
        auto found = windows_.find(window);
        if (found == windows_.end()) found = windows_.emplace(window, make_window(window)).first;
        return found->second;
    }

    // The mesh's triangles, dealt out to its windows by the triangles that show them. An outline of n corners
    // makes about n triangles each time the whole window is shown.
    size_t corner_target(const Window& window) const {
        const WindowUse& use = uses_.at(window);
        double shown = std::max(use.uv_area / double(window.count_u * window.count_v), 1.0e-6);
        double share = double(use.triangles) / double(mesh_.triangle_count());
        return std::clamp(size_t(double(settings_.triangle_target) * share / shown), k_least_corners,
                          k_most_corners);
    }

    // Mean alpha of `step` x `step` texels, from texel (x, y) of the repeated texture on.
    float mean_alpha(int64_t x, int64_t y, int64_t step) const {
        uint64_t sum = 0;
        for (int64_t j = 0; j < step; ++j)
            for (int64_t i = 0; i < step; ++i) {
                size_t column = size_t(wrap_texel(x + i, picture_.width, wrap_s_));
                size_t row = size_t(wrap_texel(y + j, picture_.height, wrap_t_));
                sum += picture_.rgba[(row * picture_.width + column) * 4 + 3];
            }
        return float(double(sum) / double(step * step));
    }

    // The window's alpha on a grid of one line every `step` texels, in texels from the window's corner.
    AlphaGrid make_grid(const Window& window, int64_t step) const {
        int64_t width = window.count_u * picture_.width, height = window.count_v * picture_.height;
        int64_t columns = (width + step - 1) / step, rows = (height + step - 1) / step;
        // Grid lines: the window's border twice (outside nothing is opaque), and the middles of the texels.
        auto lines = [step](int64_t size, int64_t count) {
            std::vector<double> at{0.0, 0.0};
            for (int64_t i = 0; i < count; ++i)
                at.push_back(std::min((double(i) + 0.5) * double(step), double(size)));
            at.insert(at.end(), {double(size), double(size)});
            return at;
        };
        AlphaGrid grid{lines(width, columns), lines(height, rows), {}};
        int64_t x0 = window.first_u * picture_.width, y0 = window.first_v * picture_.height;
        // One ring of texels around the window is what bilinear filtering sees at its border.
        std::vector<float> alpha(size_t(columns + 2) * size_t(rows + 2));
        for (int64_t y = -1; y <= rows; ++y)
            for (int64_t x = -1; x <= columns; ++x)
                alpha[size_t(y + 1) * size_t(columns + 2) + size_t(x + 1)] =
                    mean_alpha(x0 + x * step, y0 + y * step, step);
        size_t across = grid.xs.size(), down = grid.ys.size();
        grid.values.assign(across * down, opaque_alpha_ - 1.0f);
        // The first and last line of texels stand between two texels, the others on one.
        auto texels_at = [](size_t line, size_t count) {
            return line == 1           ? std::pair<size_t, size_t>(0, 1)
                   : line == count - 2 ? std::pair<size_t, size_t>(line - 2, line - 1)
                                       : std::pair<size_t, size_t>(line - 1, line - 1);
        };
        for (size_t y = 1; y + 1 < down; ++y)
            for (size_t x = 1; x + 1 < across; ++x) {
                auto [left, right] = texels_at(x, across);
                auto [top, bottom] = texels_at(y, down);
                const float *upper = &alpha[top * size_t(columns + 2)],
                            *lower = &alpha[bottom * size_t(columns + 2)];
                grid.values[y * across + x] =
                    (upper[left] + upper[right] + lower[left] + lower[right]) * 0.25f;
            }
        return grid;
    }

    // Averaging moves the border of what is opaque, and thin or scattered things vanish under it. So averaged
    // grids get the threshold that gives the texture's own opaque area; a little noise breaks the ties of
    // regular patterns.
    std::vector<Ring> trace_averaged(AlphaGrid grid, double opaque_area) const {
        size_t across = grid.xs.size(), down = grid.ys.size();
        for (size_t y = 0; y < down; ++y)
            for (size_t x = 0; x < across; ++x) {
                bool outside = x == 0 || y == 0 || x + 1 == across || y + 1 == down;
                float noise = float(mix_bits(uint32_t(y * across + x)) >> 8) * 0x1p-24f;
                grid.values[y * across + x] = outside ? -1.0f : grid.values[y * across + x] + noise;
            }
        float low = 0.0f, high = 256.0f;  // all of it is opaque; nothing is
        for (int halving = 0; halving < 16; ++halving) {
            float middle = (low + high) * 0.5f;
            (area_of(trace_outline(grid, middle)) > opaque_area ? low : high) = middle;
        }
        return trace_outline(grid, high);
    }

    static double area_of(const std::vector<Ring>& rings) {
        double area = 0.0;
        for (const Ring& ring : rings) area += signed_area(ring);
        return area;
    }
    static size_t corner_count_of(const std::vector<Ring>& rings) {
        size_t count = 0;
        for (const Ring& ring : rings) count += ring.size();
        return count;
    }

    double opaque_texels(const Window& window) const {
        uint64_t count = 0;
        for (int64_t y = 0; y < window.count_v * picture_.height; ++y) {
            size_t row = size_t(wrap_texel(window.first_v * picture_.height + y, picture_.height, wrap_t_)) *
                         picture_.width;
            for (int64_t x = 0; x < window.count_u * picture_.width; ++x) {
                size_t column =
                    size_t(wrap_texel(window.first_u * picture_.width + x, picture_.width, wrap_s_));
                count += float(picture_.rgba[(row + column) * 4 + 3]) >= opaque_alpha_;
            }
        }
        return double(count);
    }

    WindowMesh make_window(const Window& window) const {
        int64_t width = window.count_u * picture_.width, height = window.count_v * picture_.height;
        int64_t step = 1;
        while (std::max(width, height) / step > int64_t(settings_.grid_side_limit)) step *= 2;
        std::vector<Ring> rings;
        for (;; step *= 2) {
            rings = step == 1 ? trace_outline(make_grid(window, step), opaque_alpha_)
                              : trace_averaged(make_grid(window, step), opaque_texels(window));
            if (corner_count_of(rings) > k_most_traced) continue;
            OutlineLimits limits;
            limits.displaced_area = double(settings_.displaced_share) * std::fabs(area_of(rings));
            limits.corner_count = corner_target(window);
            limits.low = dvec2(0.0);
            limits.high = dvec2(double(width), double(height));
            rings = simplify_outline(rings, limits);
            if (corner_count_of(rings) <= k_most_corners) break;
        }
        FlatMesh flat = triangulate_outline(rings);

        WindowMesh mesh;
        std::vector<vec2> uvs;
        for (dvec2 corner : flat.corners) {
            mesh.uvs.push_back(corner / dvec2(double(picture_.width), double(picture_.height)) +
                               dvec2(double(window.first_u), double(window.first_v)));
            uvs.push_back(vec2(mesh.uvs.back()));
        }
        mesh.indices = std::move(flat.indices);
        mesh.colors = average_colors(texture_, uvs, mesh.indices);
        keep_mean(mesh);
        return mesh;
    }

    // A rough outline takes in transparent texels, which have no colour to give; so the mean is put right at
    // the end.
    void keep_mean(WindowMesh& mesh) const {
        vec4 all = texture_.texel(vec2(0.0f), texture_.level_count() - 1);
        dvec3 sum(0.0);
        double area = 0.0;
        for (size_t t = 0; t < mesh.indices.size(); t += 3) {
            const uint32_t* v = &mesh.indices[t];
            double weight = cross_at(mesh.uvs[v[0]], mesh.uvs[v[1]], mesh.uvs[v[2]]);
            sum += dvec3(mesh.colors[v[0]] + mesh.colors[v[1]] + mesh.colors[v[2]]) * (weight / 3.0);
            area += weight;
        }
        if (!(all.w > 0.0f) || !(area > 0.0)) return;
        for (int c = 0; c < 3; ++c) {
            float factor = sum[c] > 0.0 ? float(double(all[c] / all.w) * area / sum[c]) : 1.0f;
            for (vec3& color : mesh.colors) color[c] = std::min(color[c] * factor, 1.0f);
        }
    }

    const ImportMesh& mesh_;
    const Picture& picture_;
    GltfWrap wrap_s_, wrap_t_;
    float opaque_alpha_;
    const AlphaCutSettings& settings_;
    TexturePyramid texture_;
    std::map<Window, WindowUse> uses_;
    std::map<Window, WindowMesh> windows_;
    std::map<std::vector<int64_t>, Cut> cuts_;
    ImportMesh out_;
};

}  // namespace

ImportMesh cut_alpha(const ImportMesh& mesh, const Picture& picture, GltfWrap wrap_s, GltfWrap wrap_t,
                     float opaque_alpha, const AlphaCutSettings& settings) {
    return Cutter(mesh, picture, wrap_s, wrap_t, opaque_alpha, settings).run();
}

}  // namespace coppice
