// Compiled once for each CPU target; the operations of light_point.cpp and brdf.cpp in the same order, none of them
// fused.

#include "shade/light_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/light_points.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <cmath>
#include <glm/geometric.hpp>
#include <hwy/highway.h>
#include <limits>
#include <numbers>

#include "shade/brdf.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kAll = PointBatch::kLanes;
using F = hn::CappedTag<float, kAll>;
using I = hn::RebindToSigned<F>;
using Vec = hn::Vec<F>;
using Mask = hn::Mask<F>;
using Lanes = PointBatch::Lanes;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));
constexpr float kInversePi = static_cast<float>(std::numbers::inv_pi);

// As glm::vec3.
struct V3 {
    Vec x, y, z;
};
HWY_INLINE V3 operator+(V3 a, V3 b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(V3 a, V3 b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator*(V3 a, V3 b) {
    return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
HWY_INLINE V3 operator*(Vec a, V3 b) {
    return {hn::Mul(a, b.x), hn::Mul(a, b.y), hn::Mul(a, b.z)};
}
HWY_INLINE V3 operator/(V3 a, Vec b) {
    return {hn::Div(a.x, b), hn::Div(a.y, b), hn::Div(a.z, b)};
}
HWY_INLINE V3 choose(Mask m, V3 yes, V3 no) {
    return {hn::IfThenElse(m, yes.x, no.x), hn::IfThenElse(m, yes.y, no.y), hn::IfThenElse(m, yes.z, no.z)};
}
HWY_INLINE V3 where(Mask m, V3 v) {
    return {hn::IfThenElseZero(m, v.x), hn::IfThenElseZero(m, v.y), hn::IfThenElseZero(m, v.z)};
}
HWY_INLINE V3 all(F f, const glm::vec3& v) {
    return {hn::Set(f, v.x), hn::Set(f, v.y), hn::Set(f, v.z)};
}
HWY_INLINE V3 all(F f, float v) {
    return {hn::Set(f, v), hn::Set(f, v), hn::Set(f, v)};
}
HWY_INLINE V3 load(F f, const Lanes* from, int first) {
    return {hn::Load(f, from[0] + first), hn::Load(f, from[1] + first), hn::Load(f, from[2] + first)};
}
HWY_INLINE void store(F f, V3 v, Lanes* to, int first) {
    hn::Store(v.x, f, to[0] + first);
    hn::Store(v.y, f, to[1] + first);
    hn::Store(v.z, f, to[2] + first);
}
HWY_INLINE Vec dot(V3 a, V3 b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec sum(V3 v) {
    return hn::Add(hn::Add(v.x, v.y), v.z);
}
HWY_INLINE Mask is_zero(F f, V3 v) {
    const Vec zero = hn::Zero(f);
    return hn::And(hn::And(hn::Eq(v.x, zero), hn::Eq(v.y, zero)), hn::Eq(v.z, zero));
}
HWY_INLINE V3 cross(V3 a, V3 b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}

// std::max(), std::min() and std::clamp(), also of what is not a number.
HWY_INLINE Vec larger(Vec a, Vec b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}
HWY_INLINE Vec smaller(Vec a, Vec b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}
HWY_INLINE Vec clamped(F f, Vec x, float low, float high) {
    const Vec lo = hn::Set(f, low), hi = hn::Set(f, high);
    return hn::IfThenElse(hn::Lt(x, lo), lo, hn::IfThenElse(hn::Lt(hi, x), hi, x));
}
// glm::mix()
HWY_INLINE Vec mixed(F f, Vec a, Vec b, Vec share) {
    return hn::Add(hn::Mul(a, hn::Sub(hn::Set(f, 1.0f), share)), hn::Mul(b, share));
}
HWY_INLINE Vec fifth_power(Vec x) {
    return hn::Mul(hn::Mul(hn::Mul(hn::Mul(x, x), x), x), x);
}
HWY_INLINE std::uint32_t bits_of(F f, Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(f, mask, bytes);
    return bytes[0] | static_cast<std::uint32_t>(kWidth > 8 ? bytes[1] : 0) << 8;
}
HWY_INLINE V3 normalized_or(F f, V3 v, V3 otherwise) {
    const Vec length2 = dot(v, v);
    const Mask good = hn::And(hn::Gt(length2, hn::Zero(f)), hn::IsFinite(length2));
    return choose(good, v / hn::Sqrt(length2), otherwise);
}

// Where the eye's ray would be mirrored into the surface, which few points do, one after the other.
HWY_INLINE V3 visible(F f, V3 normal, V3 face, V3 to_eye) {
    const Vec height = dot(to_eye, face);
    const Vec least = smaller(hn::Mul(hn::Set(f, 0.9f), height), hn::Set(f, 0.01f));
    const Vec mirrored = hn::Sub(hn::Mul(hn::Mul(hn::Set(f, 2.0f), dot(normal, to_eye)), dot(normal, face)), height);
    const Mask bent = hn::And(hn::Gt(height, hn::Zero(f)), hn::Not(hn::Ge(mirrored, least)));
    if (hn::AllFalse(f, bent)) return normal;
    alignas(64) Lanes n[3], a[3], e[3];
    store(f, normal, n, 0);
    store(f, face, a, 0);
    store(f, to_eye, e, 0);
    const std::uint32_t bits = bits_of(f, bent);
    for (int lane = 0; lane < kWidth; ++lane) {
        if ((bits >> lane & 1u) == 0) continue;
        const auto at = [lane](const Lanes* from) { return glm::vec3(from[0][lane], from[1][lane], from[2][lane]); };
        const glm::vec3 now = visible_normal(at(n), at(a), at(e));
        for (int k = 0; k < 3; ++k) n[k][lane] = now[k];
    }
    return load(f, n, 0);
}

// specular_albedo()
HWY_INLINE void albedo(F f, Vec cos_view, Vec roughness, Vec& constant, Vec& grazing) {
    const I d;
    constexpr int kSize = 32;
    const Vec most = hn::Set(f, static_cast<float>(kSize - 1));
    const Vec x = hn::Mul(hn::Sqrt(clamped(f, cos_view, 0.0f, 1.0f)), most);
    const Vec y = hn::Mul(clamped(f, roughness, 0.0f, 1.0f), most);
    const auto last = hn::Set(d, kSize - 2);
    const auto j = hn::Min(hn::ConvertTo(d, x), last), i = hn::Min(hn::ConvertTo(d, y), last);
    const Vec u = hn::Sub(x, hn::ConvertTo(f, j)), v = hn::Sub(y, hn::ConvertTo(f, i));
    const auto at = hn::ShiftLeft<1>(hn::Add(hn::ShiftLeft<5>(i), j));
    const float* table = &specular_albedo_table()[0].x;
    const auto between = [&](const float* corner) HWY_ATTR {
        const Vec above = mixed(f, hn::GatherIndex(f, corner, at), hn::GatherIndex(f, corner + 2, at), u);
        const Vec below =
            mixed(f, hn::GatherIndex(f, corner + 2 * kSize, at), hn::GatherIndex(f, corner + 2 * kSize + 2, at), u);
        return mixed(f, above, below, v);
    };
    constant = between(table);
    grazing = between(table + 1);
}

// Brdf
struct VectorBrdf {
    Vec cos_view, alpha2, roughness, f90;
    V3 diffuse_albedo, specular_albedo, dielectric_f0, dielectric_scale, metal_f0, metal_scale;

    HWY_INLINE VectorBrdf(F f, V3 base, Vec metallic, Vec rough, Vec cosine, V3 f0, Vec grazing_reflection,
                          BrdfModel model) {
        constexpr float kLeastCosine = 1e-3f;
        const Vec one = hn::Set(f, 1.0f), zero = hn::Zero(f);
        roughness = clamped(f, rough, kLeastRoughness, 1.0f);
        metallic = clamped(f, metallic, 0.0f, 1.0f);
        cos_view = clamped(f, cosine, kLeastCosine, 1.0f);
        alpha2 = hn::Mul(hn::Mul(hn::Mul(roughness, roughness), roughness), roughness);
        Vec constant, grazing;
        albedo(f, cos_view, roughness, constant, grazing);
        const Vec missing =
            model == BrdfModel::kGltf ? hn::Sub(hn::Div(one, hn::Add(constant, grazing)), one) : hn::Zero(f);
        const V3 ones = all(f, 1.0f);
        f90 = grazing_reflection;
        dielectric_f0 = f0;
        metal_f0 = base;
        const V3 dielectric = ones + missing * f0, metal = ones + missing * base;
        const Vec f90_part = hn::Mul(f90, grazing);
        const V3 dielectric_albedo = dielectric * (constant * f0 + V3{f90_part, f90_part, f90_part});
        const V3 metal_albedo = metal * (constant * base + V3{grazing, grazing, grazing});
        const Vec rest = hn::Sub(one, metallic);
        dielectric_scale = rest * dielectric;
        metal_scale = metallic * metal;
        const Vec reflected = larger(larger(dielectric_albedo.x, dielectric_albedo.y), dielectric_albedo.z);
        const Vec left = model == BrdfModel::kGltf ? larger(zero, hn::Sub(one, reflected)) : one;
        diffuse_albedo = hn::Mul(rest, left) * base;
        specular_albedo = {mixed(f, dielectric_albedo.x, metal_albedo.x, metallic),
                           mixed(f, dielectric_albedo.y, metal_albedo.y, metallic),
                           mixed(f, dielectric_albedo.z, metal_albedo.z, metallic)};
    }

    HWY_INLINE V3 reflected(F f, Vec cos_light, Vec cos_half, Vec cos_difference, BrdfModel model) const {
        const Vec one = hn::Set(f, 1.0f);
        const Vec ggx = hn::Add(hn::Mul(hn::Mul(cos_half, cos_half), hn::Sub(alpha2, one)), one);
        const Vec distribution = hn::Div(hn::Mul(alpha2, hn::Set(f, kInversePi)), hn::Mul(ggx, ggx));
        const auto root = [&](Vec cosine) HWY_ATTR {
            return hn::Sqrt(hn::Add(hn::Mul(hn::Mul(cosine, cosine), hn::Sub(one, alpha2)), alpha2));
        };
        const Vec masking =
            hn::Div(hn::Set(f, 0.5f), hn::Add(hn::Mul(cos_light, root(cos_view)), hn::Mul(cos_view, root(cos_light))));
        const Vec grazing = fifth_power(hn::Sub(one, clamped(f, cos_difference, 0.0f, 1.0f)));
        const V3 dielectric = dielectric_f0 + grazing * (V3{f90, f90, f90} - dielectric_f0);
        const V3 metal = metal_f0 + grazing * (all(f, 1.0f) - metal_f0);
        const V3 fresnel = dielectric_scale * dielectric + metal_scale * metal;
        V3 diffuse = hn::Set(f, kInversePi) * diffuse_albedo;
        if (model == BrdfModel::kBurley) {
            const Vec rim =
                hn::Sub(hn::Mul(hn::Mul(hn::Mul(hn::Set(f, 2.0f), roughness), cos_difference), cos_difference),
                        hn::Set(f, 0.5f));
            const auto edge = [&](Vec cosine)
                                  HWY_ATTR { return hn::Add(one, hn::Mul(rim, fifth_power(hn::Sub(one, cosine)))); };
            diffuse = hn::Mul(edge(cos_light), edge(cos_view)) * diffuse;
        }
        return cos_light * (diffuse + hn::Mul(distribution, masking) * fresnel);
    }
};

// incoming(), of a light that is not a sun.
HWY_INLINE V3 incoming_from(F f, const PosedLight& light, V3 position, V3& to_light) {
    const V3 path = all(f, light.position) - position;
    const Vec distance2 = larger(dot(path, path), hn::Set(f, 1e-12f)), distance = hn::Sqrt(distance2);
    to_light = path / distance;
    const Vec one = hn::Set(f, 1.0f);
    Vec share = hn::Div(one, distance2);
    if (light.range < std::numeric_limits<float>::infinity() && light.range > 0.0f) {
        const Vec ratio = hn::Div(distance, hn::Set(f, light.range)), ratio2 = hn::Mul(ratio, ratio);
        share = hn::Mul(share, clamped(f, hn::Sub(one, hn::Mul(ratio2, ratio2)), 0.0f, 1.0f));
    }
    if (light.kind == LightKind::kSpot) {
        const V3 away{hn::Neg(to_light.x), hn::Neg(to_light.y), hn::Neg(to_light.z)};
        const Vec along = hn::Mul(dot(away, all(f, light.direction)), hn::Set(f, light.cone_scale));
        const Vec cone = clamped(f, hn::Add(along, hn::Set(f, light.cone_offset)), 0.0f, 1.0f);
        share = hn::Mul(share, hn::Mul(cone, cone));
    }
    return share * all(f, light.intensity);
}

// kWidth points from `first` on.
class Lit {
  public:
    Lit(const ShadingScene& scene, const PointBatch& batch, const BatchTexels& texels, LitBatch& out)
        : scene_(scene), batch_(batch), material_(batch.material->material), texels_(texels), out_(out) {}

    HWY_INLINE void light(int first) const {
        const F f;
        const BoundMaterial& bound = *batch_.material;
        const V3 base = all(f, glm::vec3(material_.base_color)) * texel(f, bound.base_color, texels_.base, first) *
                        load(f, batch_.color, first);
        if (material_.unlit) return store(f, base, out_.rest, first);

        Vec metallic = hn::Set(f, material_.metallic), roughness = hn::Set(f, material_.roughness);
        if (bound.metallic_roughness.pyramid) {
            roughness = hn::Mul(roughness, hn::Load(f, texels_.metallic_roughness[0] + first));
            metallic = hn::Mul(metallic, hn::Load(f, texels_.metallic_roughness[1] + first));
        }
        const V3 position = load(f, batch_.position, first), eye = to_eye(f, position);
        const V3 face = load(f, batch_.face, first);
        V3 given = towards_eye(f, load(f, batch_.normal, first), eye, first);
        const V3 smooth = visible(f, given, face, eye);
        V3 normal = smooth;
        if (bound.normal.pyramid) {
            const Mask mapped = hn::Gt(hn::Load(f, batch_.has_tangent + first), hn::Zero(f));
            given = choose(mapped, towards_eye(f, mapped_normal(f, first), eye, first), given);
            normal = visible(f, given, face, eye);
        }
        const Mask bent = hn::Not(is_zero(f, normal - given));
        store(f, smooth, out_.smooth, first);

        V3 f0 = all(f, 0.04f);
        Vec f90 = hn::Set(f, 1.0f);
        if (material_.ior != 1.5f || material_.specular != 1.0f || material_.specular_color != glm::vec3(1.0f) ||
            bound.specular.pyramid || bound.specular_color.pyramid)
            dielectric(f, first, f0, f90);
        const BrdfModel model = scene_.options().brdf;
        const VectorBrdf brdf(f, base, metallic, roughness, dot(normal, eye), f0, f90, model);

        V3 color = all(f, material_.emissive) * texel(f, bound.emissive, texels_.emissive, first);
        const Lighting& lighting = scene_.lighting();
        for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
            const PosedLight& light = lighting.lights[i];
            V3 to_light, irradiance;
            if (light.kind == LightKind::kDirectional) {
                to_light = all(f, -light.direction);
                irradiance = all(f, light.intensity);
            } else {
                irradiance = incoming_from(f, light, position, to_light);
            }
            const V3 half = normalized_or(f, to_light + eye, normal);
            const Vec cos_light = dot(normal, to_light);
            const Mask reached = hn::AndNot(is_zero(f, irradiance), hn::Gt(cos_light, hn::Zero(f)));
            const Mask bent_there = hn::And(bent, hn::Le(dot(given, to_light), hn::Zero(f)));
            const Mask shines = hn::AndNot(bent_there, reached);  // bending must not reach the light
            LitBatch::Share& share = out_.shares[i];
            if (hn::AllFalse(f, shines)) continue;
            const Vec cos_half = larger(hn::Zero(f), dot(normal, half));
            const V3 reflected =
                where(shines, irradiance * brdf.reflected(f, cos_light, cos_half, dot(eye, half), model));
            if (!scene_.shadows().casts(i)) {
                color = color + reflected;
                continue;
            }
            const Vec lift = clamped(
                f, hn::Sub(hn::Set(f, 1.0f), hn::Div(dot(face, to_light), hn::Set(f, LitColor::kGrazing))), 0.0f, 1.0f);
            store(f, reflected, share.color, first);
            hn::Store(lift, f, share.lift + first);
            share.shadowed |= bits_of(f, hn::Not(is_zero(f, reflected))) << first;
        }
        if (lighting.ambient()) color = color + ambient(f, brdf, normal, eye, roughness, first);
        store(f, without_negligible(f, color, first), out_.rest, first);
    }

  private:
    HWY_INLINE V3 texel(F f, const BoundTexture& texture, const Lanes* from, int first) const {
        return texture.pyramid ? load(f, from, first) : all(f, 1.0f);
    }

    // ShadingScene::to_eye()
    HWY_INLINE V3 to_eye(F f, V3 position) const {
        const V3 backwards = all(f, scene_.backwards());
        if (!scene_.frame().view.perspective) return backwards;
        const Vec length = hn::Sqrt(dot(position, position));
        return choose(hn::Gt(length, hn::Zero(f)), hn::Div(hn::Set(f, -1.0f), length) * position, backwards);
    }

    HWY_INLINE V3 towards_eye(F f, V3 normal, V3 eye, int first) const {
        return hn::Load(f, batch_.side + first) * normalized_or(f, normal, eye);
    }

    HWY_INLINE V3 mapped_normal(F f, int first) const {
        const V3 texel = load(f, texels_.normal, first);
        const Vec one = hn::Set(f, 1.0f), two = hn::Set(f, 2.0f), scale = hn::Set(f, material_.normal_scale);
        const V3 normal = load(f, batch_.normal, first), along = load(f, batch_.tangent, first);
        const V3 across = hn::Load(f, batch_.tangent[3] + first) * cross(normal, along);
        const Vec x = hn::Mul(hn::Sub(hn::Mul(two, texel.x), one), scale);
        const Vec y = hn::Mul(hn::Sub(hn::Mul(two, texel.y), one), scale);
        return x * along + y * across + hn::Sub(hn::Mul(two, texel.z), one) * normal;
    }

    // DielectricReflection::of()
    HWY_INLINE void dielectric(F f, int first, V3& f0, Vec& f90) const {
        const BoundMaterial& bound = *batch_.material;
        const float ratio = material_.ior > 0.0f ? (material_.ior - 1.0f) / (material_.ior + 1.0f) : 1.0f;
        f90 = hn::Set(f, material_.specular);
        if (bound.specular.pyramid) f90 = hn::Mul(f90, hn::Load(f, texels_.specular + first));
        const V3 color =
            all(f, material_.specular_color) * texel(f, bound.specular_color, texels_.specular_color, first);
        const V3 most = hn::Set(f, ratio * ratio) * color;
        const Vec one = hn::Set(f, 1.0f);
        f0 = f90 * V3{smaller(most.x, one), smaller(most.y, one), smaller(most.z, one)};
    }

    HWY_INLINE V3 ambient(F f, const VectorBrdf& brdf, V3 normal, V3 eye, Vec roughness, int first) const {
        const Lighting& lighting = scene_.lighting();
        const V3 mirrored = hn::Mul(hn::Set(f, 2.0f), dot(normal, eye)) * normal - eye;
        V3 matte, shiny;
        if (lighting.environment == nullptr) {
            const Vec half = hn::Set(f, 0.5f);
            const V3 ground = all(f, lighting.ground), change = all(f, lighting.sky - lighting.ground);
            matte = ground + hn::Add(half, hn::Mul(half, normal.y)) * change;
            shiny = ground + hn::Add(half, hn::Mul(half, mirrored.y)) * change;
        } else {
            alignas(64) Lanes n[3], m[3], r;
            store(f, normal, n, 0);
            store(f, mirrored, m, 0);
            hn::Store(roughness, f, r);
            for (int lane = 0; lane < kWidth; ++lane) {
                if (first + lane >= batch_.count) break;
                const glm::vec3 a = lighting.environment->matte({n[0][lane], n[1][lane], n[2][lane]});
                const glm::vec3 b = lighting.environment->shiny({m[0][lane], m[1][lane], m[2][lane]}, r[lane]);
                for (int k = 0; k < 3; ++k) n[k][lane] = a[k], m[k][lane] = b[k];
            }
            matte = load(f, n, 0);
            shiny = load(f, m, 0);
        }
        V3 color = brdf.diffuse_albedo * matte + brdf.specular_albedo * shiny;
        if (batch_.material->occlusion.pyramid) {
            const Vec one = hn::Set(f, 1.0f), texel = hn::Load(f, texels_.occlusion + first);
            const Vec strength = hn::Set(f, material_.occlusion_strength);
            color = hn::Add(one, hn::Mul(strength, hn::Sub(texel, one))) * color;
        }
        return color;
    }

    // A light that adds next to nothing needs no shadow.
    HWY_INLINE V3 without_negligible(F f, V3 rest, int first) const {
        constexpr std::uint32_t kEvery = kWidth < 16 ? (1u << kWidth) - 1 : 0xffff;
        Vec total = sum(rest);
        for (const LitBatch::Share& share : out_.shares)
            if ((share.shadowed >> first & kEvery) != 0) total = hn::Add(total, sum(shadowed_color(f, share, first)));
        const Vec least = hn::Mul(hn::Set(f, LitColor::kNegligible), total);
        for (LitBatch::Share& share : out_.shares) {
            if ((share.shadowed >> first & kEvery) == 0) continue;
            const V3 color = shadowed_color(f, share, first);
            const Mask kept = hn::Gt(sum(color), least);
            rest = rest + where(hn::Not(kept), color);
            share.shadowed &= ~((~bits_of(f, kept) & kEvery) << first);
        }
        return rest;
    }
    // Lanes without a shadow hold no light.
    HWY_INLINE V3 shadowed_color(F f, const LitBatch::Share& share, int first) const {
        return load(f, share.color, first);
    }

    const ShadingScene& scene_;
    const PointBatch& batch_;
    const Material& material_;
    const BatchTexels& texels_;
    LitBatch& out_;
};

void light_lanes(const ShadingScene& scene, const PointBatch& batch, const BatchTexels& texels, LitBatch& out) {
    const Lit lit(scene, batch, texels, out);
    for (int first = 0; first < batch.count; first += kWidth) lit.light(first);
}

}  // namespace

LightPoints::LightLanes light_lanes_function() {
    return light_lanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {
namespace {

LightPoints::LightLanes light_lanes_for_cpu() {
    PENTAPRISM_RETURN_FOR_CPU(light_lanes_function());
    return HWY_STATIC_DISPATCH(light_lanes_function)();
}

}  // namespace

void LitBatch::get(const PointBatch& batch, int lane, LitColor& out) const {
    const auto at = [lane](const PointBatch::Lanes* from) {
        return glm::vec3(from[0][lane], from[1][lane], from[2][lane]);
    };
    out.rest = at(rest);
    out.position = at(batch.position);
    out.shadowed.clear();
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const Share& share = shares[i];
        if ((share.shadowed >> lane & 1u) == 0) continue;
        const float lift = share.lift[lane];
        out.shadowed.push_back({static_cast<std::uint32_t>(i), at(share.color),
                                lift > 0.0f ? lift * (batch.bulge[lane] * at(smooth)) : glm::vec3(0.0f)});
    }
}

LightPoints::LightPoints() : light_lanes_(light_lanes_for_cpu()) {}

void LightPoints::light(const ShadingScene& scene, const PointBatch& batch, LitBatch& out) {
    out.shares.resize(scene.lighting().lights.size());
    for (LitBatch::Share& share : out.shares) share.shadowed = 0;
    texels_.look_up(batch);
    light_lanes_(scene, batch, texels_, out);
}

}  // namespace pentaprism
#endif
