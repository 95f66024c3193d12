// Twin of shade/brdf.h: glTF metallic-roughness, varnish and fibres.

#include "scene/texture.glsl"

const float kInversePi = 0.318309886183790672;
const float kLeastRoughness = 0.045, kLeastSheenRoughness = 0.07, kLeastCosine = 1e-3, kDielectricF0 = 0.04;
const int kGltf = 0, kBurley = 1;  // BrdfModel

uniform int brdf_model;

float fifth_power(float x) {
    return x * x * x * x * x;
}

// Where a table of n x n is read: columns by the root of the cosine, rows by roughness.
struct TablePlace {
    int at;  // of the corner
    vec2 share;
};

TablePlace table_place(int n, float cos_view, float roughness) {
    float x = sqrt(clamp(cos_view, 0.0, 1.0)) * float(n - 1), y = clamp(roughness, 0.0, 1.0) * float(n - 1);
    int j = min(int(x), n - 2), i = min(int(y), n - 2);
    return TablePlace(i * n + j, vec2(x - float(j), y - float(i)));
}

vec2 specular_albedo(float cos_view, float roughness) {
    TablePlace p = table_place(32, cos_view, roughness);
    return mix(mix(specular_albedos[p.at], specular_albedos[p.at + 1], p.share.x),
               mix(specular_albedos[p.at + 32], specular_albedos[p.at + 33], p.share.x), p.share.y);
}

float sheen_albedo(float cos_view, float roughness) {
    TablePlace p = table_place(16, cos_view, roughness);
    float low = sheen_albedos[p.at] + (sheen_albedos[p.at + 1] - sheen_albedos[p.at]) * p.share.x;
    float high = sheen_albedos[p.at + 16] + (sheen_albedos[p.at + 17] - sheen_albedos[p.at + 16]) * p.share.x;
    return low + (high - low) * p.share.y;
}

// DielectricReflection: f0, f90.
vec4 dielectric_reflection(float ior, float specular, vec3 specular_color) {
    float ratio = ior > 0.0 ? (ior - 1.0) / (ior + 1.0) : 1.0;
    return vec4(min(ratio * ratio * specular_color, vec3(1.0)) * specular, specular);
}

struct Brdf {
    float cos_view, alpha2, roughness, dielectric_f90;
    vec3 diffuse_albedo, specular_albedo;
    vec3 dielectric_f0, dielectric_scale, metal_f0, metal_scale;
};

Brdf make_brdf(vec3 base, float metallic, float roughness, float cos_view, vec4 reflection) {
    Brdf made;
    made.roughness = clamp(roughness, kLeastRoughness, 1.0);
    metallic = clamp(metallic, 0.0, 1.0);
    made.cos_view = clamp(cos_view, kLeastCosine, 1.0);
    made.alpha2 = made.roughness * made.roughness * made.roughness * made.roughness;
    vec2 albedo = specular_albedo(made.cos_view, made.roughness);
    float missing = brdf_model == kGltf ? 1.0 / (albedo.x + albedo.y) - 1.0 : 0.0;

    vec3 dielectric = 1.0 + reflection.xyz * missing;
    vec3 dielectric_albedo = dielectric * (reflection.xyz * albedo.x + reflection.w * albedo.y);
    vec3 metal = 1.0 + base * missing;
    vec3 metal_albedo = metal * (base * albedo.x + albedo.y);

    made.dielectric_f0 = reflection.xyz;
    made.dielectric_f90 = reflection.w;
    made.metal_f0 = base;
    made.dielectric_scale = dielectric * (1.0 - metallic);
    made.metal_scale = metal * metallic;
    float reflected = max(max(dielectric_albedo.x, dielectric_albedo.y), dielectric_albedo.z);
    float left = brdf_model == kGltf ? max(0.0, 1.0 - reflected) : 1.0;
    made.diffuse_albedo = base * ((1.0 - metallic) * left);
    made.specular_albedo = mix(dielectric_albedo, metal_albedo, metallic);
    return made;
}

// Distribution times masking.
float ggx(float alpha2, float cos_light, float cos_view, float cos_half) {
    float base = cos_half * cos_half * (alpha2 - 1.0) + 1.0;
    return alpha2 * kInversePi / (base * base) *
           (0.5 / (cos_light * sqrt(cos_view * cos_view * (1.0 - alpha2) + alpha2) +
                   cos_view * sqrt(cos_light * cos_light * (1.0 - alpha2) + alpha2)));
}

vec3 brdf_reflected(Brdf brdf, float cos_light, float cos_half, float cos_difference) {
    float lobe = ggx(brdf.alpha2, cos_light, brdf.cos_view, cos_half);
    float grazing = fifth_power(1.0 - clamp(cos_difference, 0.0, 1.0));
    vec3 dielectric = brdf.dielectric_f0 + (brdf.dielectric_f90 - brdf.dielectric_f0) * grazing;
    vec3 metal = brdf.metal_f0 + (1.0 - brdf.metal_f0) * grazing;
    vec3 fresnel = brdf.dielectric_scale * dielectric + brdf.metal_scale * metal;
    vec3 diffuse = brdf.diffuse_albedo * kInversePi;
    if (brdf_model == kBurley) {
        float rim = 2.0 * brdf.roughness * cos_difference * cos_difference - 0.5;
        diffuse *= (1.0 + rim * fifth_power(1.0 - cos_light)) * (1.0 + rim * fifth_power(1.0 - brdf.cos_view));
    }
    return (diffuse + lobe * fresnel) * cos_light;
}

struct Coat {
    float cos_view, alpha2, scale, albedo;
};

Coat make_coat(float share, float roughness, float cos_view) {
    Coat coat;
    roughness = clamp(roughness, kLeastRoughness, 1.0);
    coat.cos_view = clamp(cos_view, kLeastCosine, 1.0);
    coat.alpha2 = roughness * roughness * roughness * roughness;
    vec2 albedo = specular_albedo(coat.cos_view, roughness);
    coat.scale = share * (1.0 + kDielectricF0 * (1.0 / (albedo.x + albedo.y) - 1.0));
    coat.albedo = coat.scale * (kDielectricF0 * albedo.x + albedo.y);
    return coat;
}

float coat_reflected(Coat coat, float cos_light, float cos_half, float cos_difference) {
    float lobe = ggx(coat.alpha2, cos_light, coat.cos_view, cos_half);
    float grazing = fifth_power(1.0 - clamp(cos_difference, 0.0, 1.0));
    return coat.scale * lobe * (kDielectricF0 + (1.0 - kDielectricF0) * grazing) * cos_light;
}

struct Sheen {
    float cos_view, inverse_alpha;
    vec3 color, albedo;
};

Sheen make_sheen(vec3 color, float roughness, float cos_view) {
    Sheen sheen;
    roughness = clamp(roughness, kLeastSheenRoughness, 1.0);
    sheen.cos_view = clamp(cos_view, kLeastCosine, 1.0);
    sheen.inverse_alpha = 1.0 / (roughness * roughness);
    sheen.color = color;
    sheen.albedo = color * sheen_albedo(sheen.cos_view, roughness);
    return sheen;
}

vec3 sheen_reflected(Sheen sheen, float cos_light, float cos_half) {
    float sine2 = max(0.0, 1.0 - cos_half * cos_half);
    float power = sine2 > 0.0 ? pow(sine2, 0.5 * sheen.inverse_alpha) : 0.0;
    float distribution = (2.0 + sheen.inverse_alpha) * power * (0.5 * kInversePi);
    float fibres = distribution / (4.0 * (cos_light + sheen.cos_view - cos_light * sheen.cos_view));
    return sheen.color * (fibres * cos_light);
}
