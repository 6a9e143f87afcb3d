#include "plugins/vegetation/cook/cook_plant.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <tuple>
#include <fmt/format.h>
#include "plugins/vegetation/cook/build_octree.h"
#include "plugins/vegetation/cook/classify.h"
#include "plugins/vegetation/cook/clean_mesh.h"
#include "plugins/vegetation/cook/closed_share.h"
#include "plugins/vegetation/cook/cut_part.h"
#include "plugins/vegetation/cook/group_triangles.h"
#include "plugins/vegetation/cook/importance.h"
#include "plugins/vegetation/cook/measure_coverage.h"
#include "plugins/vegetation/cook/measure_projection.h"
#include "plugins/vegetation/cook/merge_parts.h"
#include "plugins/vegetation/cook/openness.h"
#include "plugins/vegetation/cook/pack_leaves.h"
#include "plugins/vegetation/cook/space_curve.h"
#include "plugins/vegetation/cook/trace_lines.h"
#include "plugins/vegetation/cook/triangle_areas.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "plugins/vegetation/plant/pack.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "runtime/core/progress.h"

namespace coppice {
namespace {

constexpr uint32_t k_triangle_limit = 1u << 26;  // of a plant: 3 GiB of vertices
constexpr size_t k_grain = 1 << 13;

PackedVertex pack_vertex(vec3 position, const Surface& surface, uint32_t dither) {
    return {position.x, position.y, position.z, encode_surface(surface, dither)};
}

SampleSettings sample_settings(const CookSettings& settings, uint64_t seed) {
    return {settings.sampler, settings.order, settings.points_per_triangle, seed};
}

// Appends one part to the plant. seed, line_limit: of this part.
class PartPacker {
  public:
    PartPacker(const CookPart& part, float importance, const OpennessGrid& openness,
               const CookSettings& settings, uint64_t seed, uint64_t line_limit, PlantBlocks& plant)
        : part_(part),
          importance_(importance),
          mesh_(part.shape.part),
          openness_(openness),
          settings_(settings),
          seed_(seed),
          line_limit_(line_limit),
          plant_(plant),
          dither_seed_(uint32_t(seed)) {}

    Status run() {
        copy_name(mesh_.name, packed_.name, sizeof packed_.name);
        bool lines = mesh_.kind == PartKind::lines;
        packed_.kind = lines ? PackedPartKind::lines : PackedPartKind::points;
        packed_.flags = (part_.closed ? k_part_closed : 0u) | (mesh_.leaf ? k_part_leaf : 0u) |
                        (part_.closed && !mesh_.leaf && faces_outwards() ? k_part_faces_outwards : 0u) |
                        (part_.asked == PartKind::leaves ? k_part_prefers_leaves : 0u);
        packed_.importance = importance_;
        packed_.area_m2 = float(part_.area_m2);
        packed_.projected_area_m2 = fit_direction_form(projected_areas_m2(mesh_, part_.closed));
        for (int c = 0; c < 3; ++c) packed_.mean_color_linear[c] = part_.mean_color_linear[c];
        packed_.first_triangle = uint32_t(plant_.triangle_vertices.size() / 3);
        packed_.first_point = uint32_t(plant_.points.size());
        packed_.first_line = uint32_t(plant_.line_vertices.size() / 2);
        pack_triangles();
        if (lines) {
            COPPICE_CHECK(pack_lines());
        } else {
            pack_points();
        }
        for (int axis = 0; axis < 3; ++axis) {
            packed_.bounds_min[axis] = bounds_.min[axis];
            packed_.bounds_max[axis] = bounds_.max[axis];
        }
        plant_.bounds_plant.include(bounds_);
        plant_.parts.push_back(packed_);
        if (mesh_.leaf && !lines && part_.asked != PartKind::points) pack_crown();
        return {};
    }

    // Of triangles and lines as packed; empty where there are no lines.
    std::vector<uint32_t> take_line_of_triangle() { return std::move(line_of_triangle_); }

  private:
    const DescriptionVertex& corner(size_t triangle, size_t k) const {
        return mesh_.vertices[mesh_.indices[3 * triangle + k]];
    }
    // Winding and normals agree (nearly) everywhere: a closed surface then never shows its back faces.
    bool faces_outwards() const {
        double agreeing = 0.0, total = 0.0;
        for (size_t t = 0; t < mesh_.indices.size() / 3; ++t) {
            vec3 a = corner(t, 0).position_plant;
            vec3 face = glm::cross(corner(t, 1).position_plant - a, corner(t, 2).position_plant - a);
            vec3 normal = corner(t, 0).normal_plant + corner(t, 1).normal_plant + corner(t, 2).normal_plant;
            double area = double(std::sqrt(glm::dot(face, face)));
            total += area;
            if (glm::dot(face, normal) > 0.0f) agreeing += area;
        }
        return agreeing >= 0.99 * total;
    }
    uint32_t dither(size_t item) const { return mix_bits(uint32_t(item) ^ dither_seed_); }

    void pack_triangles() {
        size_t count = mesh_.indices.size() / 3;
        std::vector<vec3> centers(count);
        for (size_t t = 0; t < count; ++t)
            centers[t] =
                (corner(t, 0).position_plant + corner(t, 1).position_plant + corner(t, 2).position_plant) *
                (1.0f / 3.0f);
        curve_ = order_along_curve(centers);
        std::vector<uint32_t> places =
            make_prefix_order(uint32_t(count), settings_.order, hash_combine(seed_, 2));
        triangle_order_.resize(count);
        for (size_t i = 0; i < count; ++i) triangle_order_[i] = curve_[places[i]];

        size_t first = plant_.triangle_vertices.size();
        plant_.triangle_vertices.resize(first + 3 * count);
        parallel_for(count, k_grain, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                for (size_t k = 0; k < 3; ++k) {
                    const DescriptionVertex& v = corner(triangle_order_[i], k);
                    Surface surface{v.normal_plant, v.color_linear, openness_.at(v.position_plant),
                                    mesh_.leaf};
                    plant_.triangle_vertices[first + 3 * i + k] =
                        pack_vertex(v.position_plant, surface, dither(3 * i + k));
                }
        });
        packed_.triangle_count = uint32_t(count);
        float longest_square = 0.0f;
        for (size_t t = 0; t < count; ++t)
            for (size_t k = 0; k < 3; ++k) {
                vec3 edge = corner(t, (k + 1) % 3).position_plant - corner(t, k).position_plant;
                longest_square = std::max(longest_square, glm::dot(edge, edge));
                bounds_.include(corner(t, k).position_plant);
            }
        packed_.longest_edge_m = std::sqrt(longest_square);
    }

    void pack_points() {
        std::vector<SampledPoint> points =
            sample_points(mesh_, curve_, triangle_order_, sample_settings(settings_, seed_)).points;
        std::vector<uint32_t> place_of(triangle_order_.size());
        for (uint32_t i = 0; i < place_of.size(); ++i) place_of[triangle_order_[i]] = i;
        size_t first = plant_.points.size();
        plant_.points.resize(first + points.size());
        plant_.point_owners.resize(first + points.size());
        parallel_for(points.size(), k_grain, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const SampledPoint& point = points[i];
                vec3 position(0), normal(0), color(0);
                for (size_t k = 0; k < 3; ++k) {
                    const DescriptionVertex& v = corner(point.triangle, k);
                    position += v.position_plant * point.share[k];
                    normal += v.normal_plant * point.share[k];
                    color += v.color_linear * point.share[k];
                }
                normal = normalize_or(normal, corner(point.triangle, 0).normal_plant);
                Surface surface{normal, color, openness_.at(position), mesh_.leaf};
                plant_.points[first + i] = pack_vertex(position, surface, dither(i));
                plant_.point_owners[first + i] = place_of[point.triangle];
            }
        });
        packed_.point_count = uint32_t(points.size());
        if (!points.empty())
            packed_.point_radius_m = float(std::sqrt(part_.area_m2 / (double(points.size()) * double(k_pi))));
    }

    void pack_crown() {
        PackedLeaves crown = pack_leaves(mesh_, packed_, openness_, dither_seed_);
        if (crown.leaves.empty()) return;
        plant_.crowns.push_back({0, 0, crown.full_count, crown.least_count});
        plant_.leaves = std::move(crown.leaves);
    }

    Status pack_lines() {
        TracedLines traced = trace_lines(mesh_, part_.shape.skeleton);
        if (traced.lines.size() > line_limit_)
            return fail(ErrorId::limit_exceeded, plant_.name, mesh_.name, "too many lines",
                        fmt::format("at most {} in a plant", settings_.primitive_limit));
        std::vector<vec3> centers, ends;
        dvec3 color(0);
        for (const TracedLine& line : traced.lines) {
            centers.push_back((line.begin_plant + line.end_plant) * 0.5f);
            ends.push_back(line.begin_plant);
            ends.push_back(line.end_plant);
            vec3 along = line.end_plant - line.begin_plant;
            color += dvec3(line.color_linear) * double(line.width_share * std::sqrt(glm::dot(along, along)));
        }
        // Where widths were clamped the mean colour would shift. One factor a channel keeps it.
        vec3 correction(1);
        for (int c = 0; c < 3; ++c) {
            double mean = color[c] / std::max(double(traced.length_m), 1e-30);
            if (mean > 1e-6)
                correction[c] = std::clamp(float(double(part_.mean_color_linear[c]) / mean), 0.5f, 2.0f);
        }
        std::vector<uint32_t> curve = order_along_curve(centers);
        std::vector<uint32_t> places =
            make_prefix_order(uint32_t(curve.size()), settings_.order, hash_combine(seed_, 3));
        std::vector<uint32_t> place_of(curve.size());
        for (uint32_t i = 0; i < places.size(); ++i) place_of[curve[places[i]]] = i;
        if (!place_of.empty())
            for (uint32_t t : triangle_order_)
                line_of_triangle_.push_back(place_of[traced.line_of_triangle[t]]);
        for (size_t i = 0; i < places.size(); ++i) {
            const TracedLine& line = traced.lines[curve[places[i]]];
            vec3 along = normalize_or(line.end_plant - line.begin_plant, vec3(0, 1, 0));
            // Of a round stem each line shows one side; in the golden angle all sides come equally often.
            float around = float(uint32_t(i) * 2654435769u >> 8) * 0x1p-24f * 2.0f * k_pi;
            vec3 normal = rotate_about(perpendicular_to(along), along, around);
            if (line.normal_plant != vec3(0))
                normal = normalize_or(line.normal_plant - along * glm::dot(along, line.normal_plant), normal);
            vec3 line_color = glm::min(line.color_linear * correction, vec3(1));
            Surface surface{normal, line_color, openness_.at(centers[curve[places[i]]]), mesh_.leaf};
            plant_.line_vertices.push_back(pack_vertex(line.begin_plant, surface, dither(i)));
            vec3 end = line.end_plant;
            plant_.line_vertices.push_back({end.x, end.y, end.z, std::bit_cast<uint32_t>(line.width_share)});
            bounds_.include(line.begin_plant);
            bounds_.include(end);
        }
        packed_.line_count = uint32_t(traced.lines.size());
        packed_.line_length_m = traced.length_m;
        packed_.line_error_m = traced.error_m;
        packed_.projected_length_m = fit_direction_form(projected_lengths_m(ends));
        return {};
    }

    const CookPart& part_;
    float importance_;
    const PartDescription& mesh_;
    const OpennessGrid& openness_;
    const CookSettings& settings_;
    uint64_t seed_, line_limit_;
    PlantBlocks& plant_;
    uint32_t dither_seed_;
    PackedPart packed_{};
    Box bounds_;
    std::vector<uint32_t> curve_, triangle_order_;  // indices of the mesh's triangles
    std::vector<uint32_t> line_of_triangle_;
};

template <class T>
void append(std::vector<T>& to, const std::vector<T>& items) {
    to.insert(to.end(), items.begin(), items.end());
}

// The part of `packed` behind the plant's, its cells behind those kept for later in `cells`: their points and
// lines follow all parts'.
void add_part(const PlantBlocks& packed, const PlantBlocks& its_cells, PlantBlocks& plant,
              PlantBlocks& cells) {
    PackedPart part = packed.parts[0];
    part.first_triangle = uint32_t(plant.triangle_vertices.size() / 3);
    part.first_point = uint32_t(plant.points.size());
    part.first_line = uint32_t(plant.line_vertices.size() / 2);
    for (PackedPart cell : its_cells.cells) {
        cell.part = uint32_t(plant.parts.size());
        cell.first_triangle += part.first_triangle;
        cell.first_point += uint32_t(cells.points.size());
        cell.first_line += uint32_t(cells.line_vertices.size() / 2);
        cells.cells.push_back(cell);
    }
    for (PackedCrown crown : packed.crowns) {
        crown.part = uint32_t(plant.parts.size());
        crown.first_leaf = uint32_t(plant.leaves.size());
        plant.crowns.push_back(crown);
    }
    append(plant.leaves, packed.leaves);
    plant.parts.push_back(part);
    append(plant.triangle_vertices, packed.triangle_vertices);
    append(plant.points, packed.points);
    append(plant.point_owners, packed.point_owners);
    append(plant.line_vertices, packed.line_vertices);
    append(cells.points, its_cells.points);
    append(cells.point_owners, its_cells.point_owners);
    append(cells.line_vertices, its_cells.line_vertices);
    plant.bounds_plant.include(packed.bounds_plant);
}

// Names are those that the packed plant has, so that what a person sees is what is named.
bool has_name(const CookPart& part, const std::string& name) {
    char packed[sizeof PackedPart::name];
    copy_name(part.shape.part.name, packed, sizeof packed);
    return name == packed;
}

Status apply_settings(const PlantDescription& plant, const CookSettings& cook, std::vector<CookPart>& parts) {
    for (const PartSettings& settings : plant.settings) {
        bool found = false;
        for (CookPart& part : parts) {
            PartDescription& mesh = part.shape.part;
            if (!has_name(part, settings.name)) continue;
            found = true;
            if (settings.importance > 0.0f) mesh.importance = settings.importance;
            part.asked = settings.kind;
            const bool lines = mesh.kind == PartKind::lines;
            if (settings.kind == PartKind::leaves && !mesh.leaf)
                return fail(ErrorId::value_out_of_range, plant.name, "part \"" + settings.name + "\"",
                            "leaves of a part that has none", "points, lines or automatic");
            if (settings.kind == PartKind::lines && !lines && cook.lines != LineParts::none) {
                part.shape.skeleton = trace_skeleton(mesh, weld_positions(mesh.vertices));
                mesh.kind = PartKind::lines;
            }
            if (lines && (settings.kind == PartKind::points || settings.kind == PartKind::leaves)) {
                part.shape.skeleton = {};
                mesh.kind = PartKind::points;
            }
        }
        if (found) continue;
        std::vector<std::string> known;
        for (const CookPart& part : parts) known.push_back(part.shape.part.name);
        log_warning("{}: there is no part \"{}\" to set anything of; parts: {}", plant.name, settings.name,
                    fmt::join(known, ", "));
    }
    return {};
}

void add_cells(const PlantBlocks& cells, PlantBlocks& plant) {
    for (PackedPart cell : cells.cells) {
        cell.first_point += uint32_t(plant.points.size());
        cell.first_line += uint32_t(plant.line_vertices.size() / 2);
        plant.cells.push_back(cell);
    }
    append(plant.points, cells.points);
    append(plant.point_owners, cells.point_owners);
    append(plant.line_vertices, cells.line_vertices);
}

}  // namespace

uint64_t hash_settings(const CookSettings& settings) {
    uint64_t hash = hash_combine(k_cook_version, uint64_t(settings.sampler));
    hash = hash_combine(hash, uint64_t(settings.order));
    hash = hash_combine(hash, std::bit_cast<uint32_t>(settings.points_per_triangle));
    hash = hash_combine(hash, settings.seed);
    return hash_combine(hash, uint64_t(settings.lines));
}

Result<std::vector<std::byte>> cook_plant(const PlantDescription& plant, const CookSettings& settings) {
    if (!(settings.points_per_triangle > 0.0f && settings.points_per_triangle <= 64.0f))
        return fail(ErrorId::value_out_of_range, plant.name, "points_per_triangle",
                    fmt::format("{}", settings.points_per_triangle),
                    "more than 0 and at most 64; the paper takes 2");
    PlantBlocks blocks;
    blocks.name = plant.name;
    CleanCounts dropped;
    std::vector<PartDescription> meshes;
    uint64_t triangle_count = 0;
    for (size_t i = 0; i < plant.parts.size(); ++i) {
        std::string place = fmt::format("parts[{}] \"{}\"", i, plant.parts[i].name);
        COPPICE_TRY(PartDescription mesh, clean_mesh(plant.parts[i], plant.name, place, dropped));
        triangle_count += mesh.indices.size() / 3;
        if (!mesh.indices.empty()) meshes.push_back(std::move(mesh));
    }
    if (meshes.empty())
        return fail(ErrorId::value_out_of_range, plant.name, "",
                    fmt::format("no triangle with an area ({} dropped)", dropped.dropped_triangles),
                    "a plant needs at least one");
    if (triangle_count > k_triangle_limit)
        return fail(ErrorId::limit_exceeded, plant.name, "", fmt::format("{} triangles", triangle_count),
                    fmt::format("at most {} a plant", k_triangle_limit));
    blocks.dropped_triangles = dropped.dropped_triangles;
    blocks.dropped_vertices = dropped.dropped_vertices + plant.dropped_vertices;

    std::optional<Progress> progress;
    if (settings.show_progress) progress.emplace("cooking " + plant.name, 2 * triangle_count);
    auto advance = [&progress](uint64_t steps) {
        if (progress) progress->advance(steps);
    };
    std::vector<std::vector<uint32_t>> welded(meshes.size());
    std::vector<bool> closed;
    for (size_t i = 0; i < meshes.size(); ++i) {
        welded[i] = weld_positions(meshes[i].vertices);
        closed.push_back(closed_share(meshes[i], welded[i]) >= k_closed_share);
    }
    OpennessGrid openness(meshes, closed);
    std::vector<CookPart> parts;
    for (size_t i = 0; i < meshes.size(); ++i) {
        uint64_t steps = meshes[i].indices.size() / 3;
        for (SlenderPart& shape : classify_part(std::move(meshes[i]), welded[i], closed[i], settings.lines)) {
            CookPart part{std::move(shape), closed[i]};
            std::tie(part.area_m2, part.mean_color_linear) = measure_area_and_color(part.shape.part);
            parts.push_back(std::move(part));
        }
        advance(steps);
    }
    if (parts.size() > k_part_limit) {
        log_note("{}: {} parts are merged into at most {}, like with like", plant.name, parts.size(),
                 k_part_limit);
        parts = merge_parts(std::move(parts));
    }
    COPPICE_CHECK(apply_settings(plant, settings, parts));

    uint64_t point_count = 0;
    std::vector<ColoredArea> colors;
    for (const CookPart& part : parts) {
        const PartDescription& mesh = part.shape.part;
        if (mesh.kind == PartKind::points) point_count += count_points(mesh, sample_settings(settings, 0));
        colors.push_back({part.mean_color_linear, part.area_m2, mesh.importance});
    }
    if (point_count > settings.primitive_limit)
        return fail(ErrorId::limit_exceeded, plant.name, "", fmt::format("{} points", point_count),
                    fmt::format("at most {} a plant: fewer points a triangle", settings.primitive_limit));
    std::vector<float> importance = choose_importance(colors);
    std::vector<PlantBlocks> packed(parts.size());
    std::vector<std::vector<uint32_t>> line_of_triangle;
    std::vector<OctreeUnits> units;
    Box bounds_plant;
    uint64_t line_count = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        packed[i].name = plant.name;
        PartPacker packer(parts[i], importance[i], openness, settings, hash_combine(settings.seed, i),
                          settings.primitive_limit - line_count, packed[i]);
        COPPICE_CHECK(packer.run());
        line_count += packed[i].line_vertices.size() / 2;
        line_of_triangle.push_back(packer.take_line_of_triangle());
        units.push_back(list_units(packed[i], line_of_triangle[i]));
        bounds_plant.include(packed[i].bounds_plant);
        advance(parts[i].shape.part.indices.size() / 3);
        parts[i] = {};
    }
    measure_coverage(packed);
    const std::vector<std::vector<uint32_t>> cell_of_unit = build_octree(units, bounds_plant);
    PlantBlocks cells;
    for (size_t i = 0; i < packed.size(); ++i) {
        const bool is_cut =
            std::any_of(cell_of_unit[i].begin(), cell_of_unit[i].end(), [](uint32_t c) { return c > 0; });
        PlantBlocks its_cells;
        if (is_cut) its_cells = cut_part(packed[i], cell_of_unit[i], line_of_triangle[i]);
        add_part(packed[i], its_cells, blocks, cells);
        packed[i] = {};
    }
    add_cells(cells, blocks);
    group_triangles(blocks);
    return pack_plant(blocks);
}

}  // namespace coppice
