// Scan conversion of a triangle by rows. A pixel is covered when its centre lies in [left, right) of its row; both
// triangles of a shared edge compute the edge from the same end first, so no pixel is covered twice or left out.
#ifndef COPPICE_SCAN_GLSL
#define COPPICE_SCAN_GLSL

// Where the edge p-q crosses row centre y; widens span if it does. Rows are half-open: [upper end, lower end).
void scan_edge(vec2 p, vec2 q, float y, inout vec2 span) {
    vec2 upper = p.y < q.y || (p.y == q.y && p.x < q.x) ? p : q;
    vec2 lower = upper == p ? q : p;
    float x = upper.x + (y - upper.y) * ((lower.x - upper.x) / (lower.y - upper.y));
    bool crosses = upper.y <= y && y < lower.y;
    span.x = crosses ? min(span.x, x) : span.x;
    span.y = crosses ? max(span.y, x) : span.y;
}

// Left and right border of the triangle on the row of pixel centres y; empty: left > right.
vec2 scan_row(vec2 a, vec2 b, vec2 c, float y) {
    vec2 span = vec2(1.0e30, -1.0e30);
    scan_edge(a, b, y, span);
    scan_edge(b, c, y, span);
    scan_edge(c, a, y, span);
    return span;
}

// For linear interpolation on the image.
struct Plane {
    vec2 to_b, to_c;  // gradients of the weights of b and c
};

Plane plane_through(vec2 a, vec2 b, vec2 c) {
    vec2 e1 = b - a, e2 = c - a;
    float area = e1.x * e2.y - e1.y * e2.x;
    float inverse = area != 0.0 ? 1.0 / area : 0.0;
    return Plane(vec2(e2.y, -e2.x) * inverse, vec2(-e1.y, e1.x) * inverse);
}

// Clamped, so that depths stay between the vertices'.
vec3 weights_at(Plane plane, vec2 a, vec2 position) {
    vec2 bc = clamp(vec2(dot(plane.to_b, position - a), dot(plane.to_c, position - a)), 0.0, 1.0);
    bc /= max(bc.x + bc.y, 1.0);
    return vec3(1.0 - bc.x - bc.y, bc);
}

// What a value at the three corners gives at a place, by how much it grows a column and a row; kept between the least and the
// largest of them.
struct Ramp {
    vec2 slope;
    float at_a, least, most;
};

Ramp ramp_through(Plane plane, vec3 values) {
    vec2 slope = plane.to_b * (values.y - values.x) + plane.to_c * (values.z - values.x);
    return Ramp(slope, values.x, min(min(values.x, values.y), values.z), max(max(values.x, values.y), values.z));
}

float ramp_at(Ramp ramp, vec2 from_a) { return clamp(ramp.at_a + dot(ramp.slope, from_a), ramp.least, ramp.most); }

// A fixed pattern over the picture with evenly spread values in [0, 1) (interleaved gradient noise, Jimenez 2014).
float dither_chance(ivec2 pixel) {
    return fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
}

#endif
