#include "plugins/vegetation/cook/take_pieces.h"

#include <cassert>

namespace coppice {

std::vector<SlenderPart> take_pieces(const SlenderPart& whole, std::span<const uint32_t> piece_of_triangle,
                                     std::span<const uint32_t> piece_of_segment, uint32_t piece_count) {
    assert(piece_of_triangle.size() == whole.part.indices.size() / 3 && "every triangle has a piece");
    assert(piece_of_segment.size() == whole.skeleton.segments.size() && "every segment has a piece");
    std::vector<SlenderPart> pieces(piece_count);
    for (SlenderPart& piece : pieces) {
        piece.part.name = whole.part.name;
        piece.part.kind = whole.part.kind;
        piece.part.leaf = whole.part.leaf;
        piece.part.importance = whole.part.importance;
    }
    std::vector<uint32_t> new_segment(piece_of_segment.size());
    for (size_t s = 0; s < new_segment.size(); ++s) {
        auto& segments = pieces[piece_of_segment[s]].skeleton.segments;
        new_segment[s] = uint32_t(segments.size());
        segments.push_back(whole.skeleton.segments[s]);
    }

    std::vector<std::vector<uint32_t>> triangles(piece_count);
    for (uint32_t t = 0; t < piece_of_triangle.size(); ++t) triangles[piece_of_triangle[t]].push_back(t);
    const auto& elements = whole.part.element_first_triangle;
    std::vector<uint32_t> element_of_triangle(elements.empty() ? 0 : piece_of_triangle.size());
    for (uint32_t e = 0; e + 1 < elements.size(); ++e)
        for (uint32_t t = elements[e]; t < elements[e + 1]; ++t) element_of_triangle[t] = e;

    std::vector<uint32_t> new_vertex(whole.part.vertices.size()),
        taken_by(whole.part.vertices.size(), UINT32_MAX);  // the last piece that took the vertex
    for (uint32_t p = 0; p < piece_count; ++p) {
        SlenderPart& piece = pieces[p];
        for (size_t i = 0; i < triangles[p].size(); ++i) {
            const uint32_t t = triangles[p][i];
            if (!whole.skeleton.triangle_segment.empty())
                piece.skeleton.triangle_segment.push_back(new_segment[whole.skeleton.triangle_segment[t]]);
            if (!elements.empty() &&
                (i == 0 || element_of_triangle[t] != element_of_triangle[triangles[p][i - 1]]))
                piece.part.element_first_triangle.push_back(uint32_t(i));
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = whole.part.indices[3 * t + k];
                if (taken_by[v] != p) {
                    taken_by[v] = p;
                    new_vertex[v] = uint32_t(piece.part.vertices.size());
                    piece.part.vertices.push_back(whole.part.vertices[v]);
                }
                piece.part.indices.push_back(new_vertex[v]);
            }
        }
        if (!elements.empty() && !triangles[p].empty())
            piece.part.element_first_triangle.push_back(uint32_t(triangles[p].size()));
    }
    return pieces;
}

}  // namespace coppice
