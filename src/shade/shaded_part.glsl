// The frame's triangles and what they carry, as gl/shading_upload.cpp writes them. Twin of moving_triangle() of
// frame/frame.h, and of ShadedPart of shade/shading_scene.h.

#include "bound/local_triangle.glsl"

// -1: none.
struct ShadedPart {
    int material;
    int positions, normals, tangents, texcoords, colors;  // the first of them in `attributes`
    uint first_point, first_triangle, vertex_count;
    int segments, moves, coordinate_sets;
};

layout(std430, binding = 2) restrict readonly buffer Parts { ShadedPart parts[]; };
layout(binding = 0) uniform samplerBuffer points;   // x, y, w, c of each vertex at each knot of its part
layout(binding = 1) uniform usamplerBuffer corners;
layout(binding = 3) uniform usamplerBuffer part_of;
layout(binding = 5) uniform samplerBuffer attributes;  // four numbers of each vertex; of coordinates both sets
layout(binding = 6) uniform usamplerBuffer source_vertices;  // of cut triangles: the corners of what they are cut from
layout(binding = 7) uniform samplerBuffer pieces;            // of cut triangles: Piece::corner

uniform bool with_pieces;

// z is w here: no depth is asked for.
MovingTriangle moving_triangle(ShadedPart part, uint triangle, int segment) {
    MovingTriangle m;
    for (int i = 0; i < 3; ++i) {
        int corner = int(texelFetch(corners, int(3u * triangle) + i).r);
        int open = corner + (part.moves != 0 ? segment * int(part.vertex_count) : 0);
        m.q[i] = texelFetch(points, open);
        m.r[i] = part.moves != 0 ? texelFetch(points, open + int(part.vertex_count)) : m.q[i];
        m.z_q[i] = m.q[i].z;
        m.z_r[i] = m.r[i].z;
    }
    return m;
}

// Frame::vertices() and in_source().
uvec3 vertices_of(ShadedPart part, uint triangle) {
    uvec3 v;
    for (int i = 0; i < 3; ++i)
        v[i] = with_pieces ? texelFetch(source_vertices, int(3u * triangle) + i).r
                           : texelFetch(corners, int(3u * triangle) + i).r - part.first_point;
    return v;
}

vec3 in_source(uint triangle, vec3 b) {
    if (!with_pieces) return b;
    vec2 p = vec2(0.0);
    for (int k = 0; k < 3; ++k)
        p += b[k] * vec2(texelFetch(pieces, int(6u * triangle) + 2 * k).r, texelFetch(pieces, int(6u * triangle) + 2 * k + 1).r);
    return vec3(1.0 - p.x - p.y, p.x, p.y);
}

// Of the three corners.
struct Corner3 {
    vec4 at[3];
};

Corner3 attributes_of(int first, uvec3 v) {
    Corner3 out_of;
    for (int k = 0; k < 3; ++k) out_of.at[k] = texelFetch(attributes, first + int(v[k]));
    return out_of;
}

vec4 interpolate(Corner3 corners, vec3 b) {
    return b.x * corners.at[0] + b.y * corners.at[1] + b.z * corners.at[2];
}
