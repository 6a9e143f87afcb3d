#include "plugins/vegetation/cook/proxy_quad.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include "plugins/vegetation/cook/clean_mesh.h"

namespace coppice {
namespace {

using Corners = std::array<vec3, 4>;

dvec3 unit_or(dvec3 v, dvec3 otherwise) {
    const double square = glm::dot(v, v);
    return square > 0.0 ? v * (1.0 / std::sqrt(square)) : otherwise;
}

struct LeafMesh {
    const PartDescription& part;
    std::span<const uint32_t> triangles;

    uint32_t vertex(uint32_t triangle, size_t corner) const {
        return part.indices[3 * size_t(triangle) + corner % 3];
    }
    vec3 place(uint32_t triangle, size_t corner) const {
        return part.vertices[vertex(triangle, corner)].position_plant;
    }
    dvec3 area_vector(uint32_t triangle) const {
        return doubled_area_vector(place(triangle, 0), place(triangle, 1), place(triangle, 2)) * 0.5;
    }
};

Corners halved_triangle(const LeafMesh& mesh) {
    const uint32_t t = mesh.triangles[0];
    size_t longest = 0;
    float longest_square = -1.0f;
    for (size_t k = 0; k < 3; ++k) {
        const vec3 edge = mesh.place(t, k + 1) - mesh.place(t, k);
        if (glm::dot(edge, edge) > longest_square) longest_square = glm::dot(edge, edge), longest = k;
    }
    const vec3 from = mesh.place(t, longest), to = mesh.place(t, longest + 1);
    return {(from + to) * 0.5f, to, mesh.place(t, longest + 2), from};
}

// The edge on which both triangles lie with opposite senses becomes the diagonal.
std::optional<Corners> joined_triangles(const LeafMesh& mesh, const std::vector<uint32_t>& welded) {
    const uint32_t a = mesh.triangles[0], b = mesh.triangles[1];
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            if (welded[mesh.vertex(a, i)] != welded[mesh.vertex(b, j + 1)] ||
                welded[mesh.vertex(a, i + 1)] != welded[mesh.vertex(b, j)] ||
                welded[mesh.vertex(a, i + 2)] == welded[mesh.vertex(b, j + 2)])
                continue;
            return Corners{mesh.place(a, i), mesh.place(b, j + 2), mesh.place(a, i + 1),
                           mesh.place(a, i + 2)};
        }
    return std::nullopt;
}

// How far the surface turns from its mean normal to both sides of a line through its middle.
struct Bend {
    double sine = 0.0;    // of the mean turn
    double droops = 1.0;  // -1: the sides rise towards the normal
};

// side: unit, at right angles to the line.
Bend find_bend(const LeafMesh& mesh, dvec3 middle, dvec3 side) {
    double square = 0.0, outwards = 0.0, weight = 0.0;
    for (uint32_t t : mesh.triangles) {
        const dvec3 n = mesh.area_vector(t);
        const double area = std::sqrt(glm::dot(n, n)), turned = glm::dot(n, side);
        const dvec3 away =
            (dvec3(mesh.place(t, 0)) + dvec3(mesh.place(t, 1)) + dvec3(mesh.place(t, 2))) * (1.0 / 3.0) -
            middle;
        square += turned * turned / area;
        outwards += turned * glm::dot(away, side);
        weight += area;
    }
    return {std::min(std::sqrt(square / weight), 0.95), outwards < 0.0 ? -1.0 : 1.0};
}

// Folded along its first half diagonal; area and the middle of the surface stay.
Corners folded_rhombus(dvec3 middle, dvec3 fold, dvec3 wing, dvec3 normal, Bend bend) {
    const double fall_m = bend.droops * bend.sine * std::sqrt(glm::dot(wing, wing));
    const dvec3 ridge = middle + normal * (fall_m / 3.0), low = ridge - normal * fall_m;
    const dvec3 reach = wing * std::sqrt(1.0 - bend.sine * bend.sine);
    return {vec3(ridge - fold), vec3(low - reach), vec3(ridge + fold), vec3(low + reach)};
}

// Axes of the surface's spread in the plane of `normal`; a rhombus of half diagonals a, b spreads by a^2 / 6 and b^2 / 6.
Corners rhombus(const LeafMesh& mesh, double area_m2, dvec3 normal, bool closed) {
    double weight = 0.0;
    dvec3 middle(0);
    for (uint32_t t : mesh.triangles) {
        const dvec3 n = mesh.area_vector(t);
        const double area = std::sqrt(glm::dot(n, n));
        for (size_t k = 0; k < 3; ++k) middle += dvec3(mesh.place(t, k)) * (area / 3.0);
        weight += area;
    }
    middle *= 1.0 / weight;
    const vec3 any = perpendicular_to(vec3(normal));
    const dvec3 e1 = unit_or(dvec3(any) - normal * glm::dot(normal, dvec3(any)), dvec3(1, 0, 0));
    const dvec3 e2 = glm::cross(normal, e1);
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (uint32_t t : mesh.triangles) {
        const dvec3 n = mesh.area_vector(t);
        const double twelfth = std::sqrt(glm::dot(n, n)) / (12.0 * weight);
        double sum_x = 0.0, sum_y = 0.0;
        auto add = [&](double x, double y) {
            xx += x * x * twelfth, xy += x * y * twelfth, yy += y * y * twelfth;
        };
        for (size_t k = 0; k < 3; ++k) {
            const dvec3 p = dvec3(mesh.place(t, k)) - middle;
            add(glm::dot(p, e1), glm::dot(p, e2));
            sum_x += glm::dot(p, e1), sum_y += glm::dot(p, e2);
        }
        add(sum_x, sum_y);
    }
    const double mean = 0.5 * (xx + yy), half = 0.5 * (xx - yy), spread = std::sqrt(half * half + xy * xy);
    // Of the two forms of the long axis the one that is not the difference of nearly equal numbers.
    const dvec3 along_raw = half >= 0.0 ? e1 * (half + spread) + e2 * xy : e1 * xy + e2 * (spread - half);
    const dvec3 along = unit_or(along_raw, e1), across = glm::cross(normal, along);
    const double long_deviation = std::sqrt(mean + spread),
                 short_deviation = std::sqrt(std::max(mean - spread, 0.0));
    // A sliver, whose short axis is lost in rounding, still gets its area.
    const double ratio = std::clamp(short_deviation / std::max(long_deviation, 1e-30), 1e-3, 1.0);
    const double a = std::sqrt(area_m2 / (2.0 * ratio)), b = a * ratio;
    if (closed) return folded_rhombus(middle, along * a, across * b, normal, {});
    const Bend lengthwise = find_bend(mesh, middle, along), crosswise = find_bend(mesh, middle, across);
    if (lengthwise.sine <= crosswise.sine)
        return folded_rhombus(middle, along * a, across * b, normal, crosswise);
    return folded_rhombus(middle, across * -b, along * a, normal, lengthwise);
}

}  // namespace

ProxyQuad fit_proxy_quad(const PartDescription& part, const std::vector<uint32_t>& welded,
                         std::span<const uint32_t> triangles, bool closed) {
    const LeafMesh mesh{part, triangles};
    dvec3 area_vector(0), largest(0), normal(0), color(0);
    double area_m2 = 0.0;
    for (uint32_t t : triangles) {
        const dvec3 n = mesh.area_vector(t);
        const double area = std::sqrt(glm::dot(n, n));
        for (size_t k = 0; k < 3; ++k) {
            const DescriptionVertex& v = part.vertices[mesh.vertex(t, k)];
            normal += dvec3(v.normal_plant) * area;
            color += dvec3(v.color_linear) * (area / 3.0);
        }
        if (glm::dot(n, n) > glm::dot(largest, largest)) largest = n;
        area_vector += n;
        area_m2 += area;
    }
    // What is closed, or folded onto itself, has no mean normal: its largest triangle lies as it does.
    constexpr double k_flat_share = 0.1;
    const bool turns_round =
        closed || glm::dot(area_vector, area_vector) < k_flat_share * k_flat_share * area_m2 * area_m2;
    const dvec3 facing = unit_or(turns_round ? largest : area_vector, dvec3(0, 1, 0));
    const double mean_normal_square = glm::dot(normal, normal) / (9.0 * area_m2 * area_m2);
    Leaf leaf;
    leaf.normal_plant =
        vec3(mean_normal_square > k_flat_share * k_flat_share ? unit_or(normal, facing) : facing);
    leaf.color_linear = glm::clamp(vec3(color * (1.0 / area_m2)), vec3(0), vec3(1));
    std::optional<Corners> corners;
    if (triangles.size() == 1) corners = halved_triangle(mesh);
    if (triangles.size() == 2) corners = joined_triangles(mesh, welded);
    leaf.corners_plant = corners ? *corners : rhombus(mesh, closed ? 0.5 * area_m2 : area_m2, facing, closed);
    return {leaf, corners.has_value()};
}

}  // namespace coppice
