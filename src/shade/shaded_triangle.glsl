// Twin of shade/shaded_triangle.h: one triangle as shading sees it, for the shading of a pixel (no cells).

#include "camera/lens.glsl"
#include "shade/brdf.glsl"
#include "shade/footprint.glsl"
#include "shade/lights.glsl"
#include "shade/shade_point.glsl"
#include "shade/shaded_part.glsl"

const float kGrazing = 0.1, kNegligible = 1.0 / 512.0;
const float kSmooth = 0.5, kSpread = 0.25;
const int kFilterOff = 0, kFilterPixel = 1, kFilterFull = 2;  // TextureFilter

// Of BoundMaterial: which of its textures.
const int kBaseColor = 0, kMetallicRoughness = 1, kNormal = 2, kOcclusion = 3, kEmissive = 4, kSpecular = 5,
          kSpecularColor = 6, kCoat = 7, kCoatRoughness = 8, kCoatNormal = 9, kSheenColor = 10, kSheenRoughness = 11,
          kTransmission = 12, kTextures = 13;

struct BoundMaterial {
    vec4 base_color;
    vec4 emissive;        // w: occlusion strength
    vec4 specular_color;  // w: specular
    vec4 sheen_color;     // w: sheen roughness
    float metallic, roughness, normal_scale, ior;
    float coat, coat_roughness, coat_normal_scale, transmission;
    int unlit, textures_used, layered, reflects;  // reflects: otherwise than a dielectric of index 1.5
    BoundTexture textures[kTextures];
};

layout(std430, binding = 3) restrict readonly buffer Materials {
    BoundMaterial materials[];
};
layout(std430, binding = 7) restrict buffer Shares {
    Share shares[];
};  // [point of the dispatch][light that casts]

uniform bool orthographic;
uniform vec4 backwards;  // against the direction of view
uniform int texture_filter;
uniform double focal_length;  // pixels

struct ShadedTriangle {
    ShadedPart part;
    uint triangle;
    uvec3 vertices;
    Corner3 positions, normals;
    vec3 face_normal;  // unit, towards the front
};

// The triangle on the screen, at mid-shutter and through the middle of the lens.
struct Projection {
    dvec3 corner[3];         // x, y, w
    dvec3 by_x, by_y, by_1;  // columns of the inverse of the corners' matrix: barycentrics over w
    dvec3 motion[3];         // of each corner over the whole shutter
    dvec3 coc;               // c of each corner
};

vec3 normalized_or(vec3 v, vec3 otherwise) {
    float length2 = dot(v, v);
    return length2 > 0.0 && !isinf(length2) && !isnan(length2) ? v / sqrt(length2) : otherwise;
}

vec3 visible_normal(vec3 normal, vec3 face, vec3 to_eye) {
    float height = dot(to_eye, face);
    float least_height = min(0.9 * height, 0.01);
    if (!(height > 0.0) || 2.0 * dot(normal, to_eye) * dot(normal, face) - height >= least_height) return normal;
    vec3 along = normalized_or(normal - dot(normal, face) * face, vec3(0.0));
    float side = dot(to_eye, along), r = sqrt(side * side + height * height);
    float turn = acos(min(least_height / r, 1.0)), phi = atan(side, height);
    float now = atan(dot(normal, along), dot(normal, face));
    float theta = clamp(now, 0.5 * (phi - turn), 0.5 * (phi + turn));
    return sin(theta) * along + cos(theta) * face;
}

ShadedTriangle shaded_triangle(uint triangle) {
    ShadedTriangle t;
    t.part = parts[texelFetch(part_of, int(triangle)).r];
    t.triangle = triangle;
    t.vertices = vertices_of(t.part, triangle);
    t.positions = attributes_of(t.part.positions, t.vertices);
    t.normals = attributes_of(t.part.normals, t.vertices);
    vec3 a = t.positions.at[0].xyz, b = t.positions.at[1].xyz, c = t.positions.at[2].xyz;
    t.face_normal = normalized_or(cross(b - a, c - a), vec3(0.0));
    return t;
}

dvec3 between_ends(vec4 open, vec4 close, double s) {
    return dvec3(open.xyz) + (dvec3(close.xyz) - dvec3(open.xyz)) * s;
}

Projection project(ShadedPart part, uint triangle) {
    Projection p;
    int segment = part.segments / 2;  // the one that holds t = 1/2
    double s = 0.5lf * double(part.segments) - double(segment);
    int from = part.segments == 1 ? 0 : -1;  // of the first, that one, the last
    for (int which = from; which <= -from; ++which) {
        MovingTriangle m = moving_triangle(part, triangle, which < 0 ? 0 : which > 0 ? part.segments - 1 : segment);
        for (int i = 0; i < 3; ++i) {
            if (which == 0) p.corner[i] = between_ends(m.q[i], m.r[i], s);
            if (which == 0) p.coc[i] = double(m.q[i].w) + (double(m.r[i].w) - double(m.q[i].w)) * s;
            if (which == from) p.motion[i] = -dvec3(m.q[i].xyz);
            if (which == -from) p.motion[i] += dvec3(m.r[i].xyz);
        }
    }
    dvec3 row0 = cross(p.corner[1], p.corner[2]), row1 = cross(p.corner[2], p.corner[0]),
          row2 = cross(p.corner[0], p.corner[1]);
    double determinant = dot(p.corner[0], row0);
    double scale = determinant != 0.0lf ? 1.0lf / determinant : 0.0lf;  // edge-on: no derivatives
    p.by_x = scale * dvec3(row0.x, row1.x, row2.x);
    p.by_y = scale * dvec3(row0.y, row1.y, row2.y);
    p.by_1 = scale * dvec3(row0.z, row1.z, row2.z);
    return p;
}

// One evaluation is filtered over its pixel (variance 1/12 each way) and over the shutter (1/12) and the lens disk (1/4
// each way).
vec3 texture_footprint(ShadedTriangle t, Projection p, vec3 barycentrics, vec2 corner_uv[3]) {
    dvec3 b = dvec3(barycentrics);
    dvec3 point = b.x * p.corner[0] + b.y * p.corner[1] + b.z * p.corner[2];
    if (!(point.z > 0.0lf) || texture_filter == kFilterOff) return vec3(0.0);
    dvec3 dx = point.z * (p.by_x - b * (p.by_x.x + p.by_x.y + p.by_x.z));
    dvec3 dy = point.z * (p.by_y - b * (p.by_y.x + p.by_y.y + p.by_y.z));
    dvec2 uv[3] = dvec2[3](dvec2(corner_uv[0]), dvec2(corner_uv[1]), dvec2(corner_uv[2]));
    dvec2 edge1 = uv[1] - uv[0], edge2 = uv[2] - uv[0];
    vec2 by_x = vec2(dx.y * edge1 + dx.z * edge2), by_y = vec2(dy.y * edge1 + dy.z * edge2);

    vec3 footprint = with_axis(with_axis(vec3(0.0), by_x, 1.0 / 12.0), by_y, 1.0 / 12.0);
    if (texture_filter == kFilterPixel) return footprint;
    dvec3 motion = b.x * p.motion[0] + b.y * p.motion[1] + b.z * p.motion[2];
    vec2 velocity = vec2((motion.xy - motion.z / point.z * point.xy) / point.z);
    float coc = float(dot(b, p.coc) / point.z), ratio = float(lens_ratio);
    float lens = 0.25 * coc * coc;
    footprint = with_axis(with_axis(footprint, by_x, lens), by_y, lens * ratio * ratio);
    return with_axis(footprint, by_x * velocity.x + by_y * velocity.y, 1.0 / 12.0);
}

vec3 smooth_offset(ShadedTriangle t, vec3 b, vec3 normal, bool front) {
    float height = 0.0, least = 1.0;
    for (int i = 0; i < 3; ++i) {
        int next = (i + 1) % 3;
        least = min(least, dot(t.normals.at[i].xyz, t.face_normal));
        float turn =
            dot(t.normals.at[next].xyz - t.normals.at[i].xyz, t.positions.at[next].xyz - t.positions.at[i].xyz);
        height += b[i] * b[next] * max(0.0, front ? turn : -turn);
    }
    return clamp((least - kSpread) / (kSmooth - kSpread), 0.0, 1.0) * height * normal;
}

vec3 decoded_normal(vec4 texel, float scale) {
    return vec3((2.0 * texel.x - 1.0) * scale, (2.0 * texel.y - 1.0) * scale, 2.0 * texel.z - 1.0);
}

vec3 mapped_normal(ShadedTriangle t, vec3 b, vec3 map) {
    vec3 normal = interpolate(t.normals, b).xyz;
    vec4 tangent = interpolate(attributes_of(t.part.tangents, t.vertices), b);
    return map.x * tangent.xyz + map.y * (cross(normal, tangent.xyz) * tangent.w) + map.z * normal;
}

// What a surface does with the light of one direction.
struct Surface {
    Brdf brdf;
    float roughness;
    vec3 normal, to_eye;
    bool has_coat, has_sheen;
    Coat coat;
    vec3 coat_normal;
    float coat_roughness;
    Sheen sheen;
    float below, sheen_scale;
};

void add_coat(inout Surface s, float share, float roughness, vec3 normal) {
    s.has_coat = true;
    s.coat_normal = normal;
    s.coat_roughness = roughness;
    s.coat = make_coat(share, roughness, dot(normal, s.to_eye));
    s.below *= 1.0 - s.coat.albedo;
}

void add_sheen(inout Surface s, vec3 color, float roughness) {
    s.has_sheen = true;
    s.sheen = make_sheen(color, roughness, dot(s.normal, s.to_eye));
    s.sheen_scale = s.below;
    s.below *= 1.0 - max(max(s.sheen.albedo.x, s.sheen.albedo.y), s.sheen.albedo.z);
}

vec3 surface_reflected(Surface s, vec3 to_light) {
    vec3 between = normalized_or(to_light + s.to_eye, s.normal);
    float cos_difference = dot(s.to_eye, between);
    vec3 color = vec3(0.0);
    float cos_light = dot(s.normal, to_light), cos_half = max(0.0, dot(s.normal, between));
    if (cos_light > 0.0) {
        color = s.below * brdf_reflected(s.brdf, cos_light, cos_half, cos_difference);
        if (s.has_sheen) color += s.sheen_scale * sheen_reflected(s.sheen, cos_light, cos_half);
    }
    if (!s.has_coat) return color;
    float coat_light = dot(s.coat_normal, to_light);
    if (coat_light > 0.0)
        color += coat_reflected(s.coat, coat_light, max(0.0, dot(s.coat_normal, between)), cos_difference);
    return color;
}

vec3 mirrored(vec3 n, vec3 to_eye) {
    return 2.0 * dot(n, to_eye) * n - to_eye;
}

vec3 surface_ambient(Surface s) {
    vec3 matte = lighting_matte(s.normal), color = vec3(0.0);
    int layers = s.has_coat ? 2 : 1;
    for (int layer = 0; layer < layers; ++layer) {
        vec3 shiny = lighting_shiny(mirrored(layer == 0 ? s.normal : s.coat_normal, s.to_eye),
                                    layer == 0 ? s.roughness : s.coat_roughness);
        if (layer > 0) {
            color += s.coat.albedo * shiny;
            continue;
        }
        color = (s.brdf.diffuse_albedo * matte + s.brdf.specular_albedo * shiny) * s.below;
        if (s.has_sheen) color += s.sheen_scale * s.sheen.albedo * matte;
    }
    return color;
}

// What the material's textures show of the point that is shaded; white without one.
vec4 looked_up[kTextures];

vec4 look_up(int which) {
    return looked_up[which];
}
bool has_texture(int material, int which) {
    return materials[material].textures[which].pyramid >= 0;
}

// Coordinates at the corner, of both sets; of a piece, in what it is cut from.
vec4 coordinates_at(ShadedTriangle t, Corner3 coordinates, int k) {
    if (!with_pieces) return coordinates.at[k];
    return interpolate(coordinates, in_source(t.triangle, vec3(k == 0, k == 1, k == 2)));
}

void look_up_textures(ShadedTriangle t, vec3 barycentrics, vec3 b) {
    for (int i = 0; i < kTextures; ++i) looked_up[i] = vec4(1.0);
    int used = materials[t.part.material].textures_used;  // the last one, and 1; 0 without textures
    if (used == 0) return;
    vec2 uv[2] = vec2[2](vec2(0.0), vec2(0.0));
    vec3 footprints[2] = vec3[2](vec3(0.0), vec3(0.0));
    if (t.part.texcoords >= 0) {
        Projection p = project(t.part, t.triangle);
        Corner3 coordinates = attributes_of(t.part.texcoords, t.vertices);
        vec4 here = interpolate(coordinates, b), corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = coordinates_at(t, coordinates, k);
        for (int set = 0; set < 2; ++set) {
            if ((t.part.coordinate_sets >> set & 1) == 0) continue;
            bool first = set == 0;
            uv[set] = first ? here.xy : here.zw;
            footprints[set] =
                texture_footprint(t, p, barycentrics,
                                  vec2[3](first ? corner[0].xy : corner[0].zw, first ? corner[1].xy : corner[1].zw,
                                          first ? corner[2].xy : corner[2].zw));
        }
    }
    for (int i = 0; i < used; ++i) {
        BoundTexture texture = materials[t.part.material].textures[i];
        if (texture.pyramid >= 0) looked_up[i] = sample_texture(texture, uv[texture.set], footprints[texture.set]);
    }
}

vec3 eye_direction(vec3 position) {
    if (orthographic) return backwards.xyz;
    float len = sqrt(dot(position, position));
    return len > 0.0 ? position * (-1.0 / len) : backwards.xyz;
}

// ShadingScene::shadow_texel()
float shadow_texel(vec3 position) {
    double depth = -dot(dvec3(position), dvec3(backwards.xyz));
    double w = orthographic ? 1.0lf : max(depth, depth_near);
    double blur = 2.0lf * abs(lens_coc(depth)) / w;
    return float(w / focal_length * max(1.0lf, 0.25lf * blur));
}

vec3 normal_towards_eye(vec3 n, bool front, vec3 to_eye) {
    vec3 unit = normalized_or(n, to_eye);
    return front ? unit : -unit;
}

float brightness(vec3 c) {
    return c.x + c.y + c.z;
}

// A light that adds less than half a code of 8 bits to what the point shows needs no shadow.
vec3 without_negligible(vec3 rest, uint first_share) {
    float total = brightness(rest);
    for (int k = 0; k < casting_lights; ++k)
        if (shares[first_share + uint(k)].state != kNoShare) total += brightness(shares[first_share + uint(k)].color);
    for (int k = 0; k < casting_lights; ++k) {
        uint at = first_share + uint(k);
        if (shares[at].state == kNoShare || brightness(shares[at].color) > kNegligible * total) continue;
        rest += shares[at].color;
        shares[at].state = kNoShare;
    }
    return rest;
}

// Writes the point's colour, position and shares.
void shade_point(uint index, uint first_share) {
    for (int k = 0; k < casting_lights; ++k) shares[first_share + uint(k)].state = kNoShare;
    vec3 barycentrics = shade_points[index].barycentrics.xyz;
    bool front = shade_points[index].front != 0u;
    ShadedTriangle t = shaded_triangle(shade_points[index].triangle);
    int m = t.part.material;
    vec3 b = in_source(t.triangle, barycentrics);
    look_up_textures(t, barycentrics, b);

    vec3 base = materials[m].base_color.rgb * look_up(kBaseColor).rgb;
    if (t.part.colors >= 0) base *= interpolate(attributes_of(t.part.colors, t.vertices), b).rgb;
    if (materials[m].unlit != 0) {
        shade_points[index].rest = vec4(base, 1.0);
        shade_points[index].position = vec4(0.0);
        return;
    }

    vec4 metallic_roughness = look_up(kMetallicRoughness);
    float metallic = materials[m].metallic * metallic_roughness.z;
    float roughness = materials[m].roughness * metallic_roughness.y;
    vec3 position = interpolate(t.positions, b).xyz;
    vec3 to_eye = eye_direction(position), face = front ? t.face_normal : -t.face_normal;
    float coat = materials[m].layered != 0 ? materials[m].coat * look_up(kCoat).x : 0.0;
    // Without a map, with it, and of the coat.
    vec3 normals[3], given;
    int normals_used = coat > 0.0 ? 3 : 2;
    for (int k = 0; k < normals_used; ++k) {
        vec3 n = interpolate(t.normals, b).xyz;
        int map = k == 1 ? kNormal : kCoatNormal;
        if (k > 0 && t.part.tangents >= 0 && has_texture(m, map))
            n = mapped_normal(
                t, b,
                decoded_normal(look_up(map), k == 1 ? materials[m].normal_scale : materials[m].coat_normal_scale));
        n = normal_towards_eye(n, front, to_eye);
        if (k == 1) given = n;
        normals[k] = visible_normal(n, face, to_eye);
    }
    vec3 even = normals[0], normal = normals[1];

    vec4 reflection = vec4(kDielectricF0, kDielectricF0, kDielectricF0, 1.0);
    if (materials[m].reflects != 0)
        reflection = dielectric_reflection(materials[m].ior, materials[m].specular_color.w * look_up(kSpecular).w,
                                           materials[m].specular_color.rgb * look_up(kSpecularColor).rgb);
    float transmission = materials[m].transmission > 0.0 ? materials[m].transmission * look_up(kTransmission).x : 0.0;
    Surface surface;
    surface.brdf = make_brdf(base, metallic, roughness, dot(normal, to_eye), reflection);
    surface.brdf.diffuse_albedo *= 1.0 - transmission * (1.0 - metallic);
    surface.roughness = roughness;
    surface.normal = normal;
    surface.to_eye = to_eye;
    surface.has_coat = surface.has_sheen = false;
    surface.below = surface.sheen_scale = 1.0;
    if (materials[m].layered != 0) {
        if (coat > 0.0) add_coat(surface, coat, materials[m].coat_roughness * look_up(kCoatRoughness).y, normals[2]);
        vec3 sheen = materials[m].sheen_color.rgb * look_up(kSheenColor).rgb;
        if (sheen != vec3(0.0)) add_sheen(surface, sheen, materials[m].sheen_color.w * look_up(kSheenRoughness).w);
    }
    // The samples that see through say nothing of what the surface reflects: the others speak for them.
    float scale = 1.0 / (1.0 - 0.875 * transmission);

    vec3 color = surface.below * materials[m].emissive.rgb * look_up(kEmissive).rgb;
    for (int i = 0; i < light_count; ++i) {
        PosedLight light = lights[i];
        Incoming from = incoming(light, position);
        if (from.irradiance == vec3(0.0)) continue;
        if (normal != given && dot(given, from.to_light) <= 0.0) continue;  // bending must not reach the light
        vec3 reflected = from.irradiance * surface_reflected(surface, from.to_light);
        if (reflected == vec3(0.0)) continue;
        if (light.share < 0) {
            color += reflected;
            continue;
        }
        float lift = clamp(1.0 - dot(face, from.to_light) / kGrazing, 0.0, 1.0);
        uint at = first_share + uint(light.share);
        shares[at].color = scale * reflected;
        shares[at].state = kOpenShare;
        shares[at].offset = lift > 0.0 ? lift * smooth_offset(t, b, even, front) : vec3(0.0);
        shares[at].lit = 0u;
    }
    if (with_ambient) {
        vec3 ambient = surface_ambient(surface);
        if (has_texture(m, kOcclusion)) ambient *= 1.0 + materials[m].emissive.w * (look_up(kOcclusion).x - 1.0);
        color += ambient;
    }
    shade_points[index].rest = vec4(without_negligible(scale * color, first_share), 1.0);
    shade_points[index].position = vec4(position, casting_lights > 0 ? shadow_texel(position) : 0.0);
}
