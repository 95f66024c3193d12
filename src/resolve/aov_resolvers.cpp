// What each output variable makes of a pixel's samples: one class each; the rules are in aov_table.cpp.

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "resolve/aov_film.h"

namespace pentaprism {
namespace {

// Means over the samples that hit something.
template <int kChannels>
class MeanResolver : public AovResolver {
  public:
    void begin(int, int) override {
        std::fill(sums_, sums_ + kChannels, 0.0);
        count_ = 0;
    }
    void miss(const glm::vec3&) override {}
    void end(float* out) override {
        for (int c = 0; c < kChannels; ++c) out[c] = count_ > 0 ? static_cast<float>(sums_[c] / count_) : 0.0f;
    }

  protected:
    void add(std::initializer_list<double> values) {
        int c = 0;
        for (const double value : values) sums_[c++] += value;
        ++count_;
    }

  private:
    double sums_[kChannels] = {};
    int count_ = 0;
};

template <typename Values>
typename Values::value_type interpolate(const Values& values, const SurfaceSample& s) {
    return s.barycentrics.x * values[s.vertices[0]] + s.barycentrics.y * values[s.vertices[1]] +
           s.barycentrics.z * values[s.vertices[2]];
}

class DepthResolver : public MeanResolver<1> {
    void hit(const SurfaceSample& s, const glm::vec3&) override { add({s.depth}); }
};

class NormalResolver : public MeanResolver<3> {
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        glm::vec3 n = interpolate(s.shaded->normals, s);
        const float length = glm::length(n);
        n = length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f);
        if (!s.front) n = -n;
        add({n.x, n.y, n.z});
    }
};

class PositionResolver : public MeanResolver<3> {
  public:
    explicit PositionResolver(const AovSources& sources) {
        const Frame& frame = sources.scene->frame();
        eye_ = glm::dvec3(glm::inverse(world_to_camera(frame.view, frame.middle))[3]);
    }
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        const glm::dvec3 p = eye_ + glm::dvec3(interpolate(s.shaded->positions, s));
        add({p.x, p.y, p.z});
    }

  private:
    glm::dvec3 eye_;
};

class UvResolver : public MeanResolver<2> {
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        const std::vector<glm::vec2>& uvs = s.shaded->primitive->texcoords[0];
        const glm::vec2 uv = uvs.empty() ? glm::vec2(0.0f) : interpolate(uvs, s);
        add({uv.x, uv.y});
    }
};

class MotionResolver : public AovResolver {
  public:
    explicit MotionResolver(const AovSources& sources) : flow_(*sources.flow) {}
    void begin(int, int) override { forward_ = backward_ = {}; }
    void miss(const glm::vec3&) override {}
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        forward_.add(flow_.forward(s));
        backward_.add(flow_.backward(s));
    }
    void end(float* out) override {
        forward_.mean(out);
        backward_.mean(out + 2);
    }

  private:
    struct Sum {
        double u = 0, v = 0;
        int count = 0;
        void add(const std::optional<glm::vec2>& way) {
            if (!way) return;
            u += way->x, v += way->y;
            ++count;
        }
        void mean(float* out) const {
            out[0] = count > 0 ? static_cast<float>(u / count) : 0.0f;
            out[1] = count > 0 ? static_cast<float>(v / count) : 0.0f;
        }
    };
    const Flow& flow_;
    Sum forward_, backward_;
};

class CocResolver : public MeanResolver<1> {
    void hit(const SurfaceSample& s, const glm::vec3&) override { add({s.coc}); }
};

// How many of a pixel's samples see each number.
class Votes {
  public:
    struct Entry {
        std::uint32_t number;
        int count;
        float first, last;  // shutter times
    };
    void clear() { entries_.clear(), total_ = 0; }
    void add(std::uint32_t number, float t) {
        ++total_;
        for (Entry& e : entries_)
            if (e.number == number) {
                ++e.count;
                e.first = std::min(e.first, t), e.last = std::max(e.last, t);
                return;
            }
        entries_.push_back({number, 1, t, t});
    }
    // Most votes first; a tie goes to the lower number.
    const std::vector<Entry>& sorted() {
        std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
            return a.count > b.count || (a.count == b.count && a.number < b.number);
        });
        return entries_;
    }
    float share(const Entry& e) const { return static_cast<float>(e.count) / static_cast<float>(total_); }

  private:
    std::vector<Entry> entries_;
    int total_ = 0;
};

const std::vector<std::uint32_t>& numbers_of_parts(const FrameIds& ids, bool materials) {
    return materials ? ids.material_of_part : ids.object_of_part;
}

class VotingResolver : public AovResolver {
  public:
    VotingResolver(const AovSources& sources, bool materials)
        : numbers_(numbers_of_parts(*sources.ids, materials)), parts_(sources.scene->frame().parts.data()) {}
    void begin(int, int) override { votes_.clear(); }
    void miss(const glm::vec3&) override { votes_.add(0, 0.0f); }
    void hit(const SurfaceSample& s, const glm::vec3&) override { votes_.add(numbers_[s.part - parts_], s.t); }

  protected:
    Votes votes_;

  private:
    const std::vector<std::uint32_t>& numbers_;
    const Part* parts_;
};

class IdResolver : public VotingResolver {
    using VotingResolver::VotingResolver;
    void end(float* out) override { *out = std::bit_cast<float>(votes_.sorted().front().number); }
};

class TimeResolver : public VotingResolver {
    using VotingResolver::VotingResolver;
    void end(float* out) override {
        std::fill(out, out + 3, 0.0f);
        for (const Votes::Entry& e : votes_.sorted()) {
            if (e.number == 0) continue;
            out[0] = e.first, out[1] = e.last, out[2] = votes_.share(e);
            return;
        }
    }
};

class CryptomatteResolver : public AovResolver {
  public:
    explicit CryptomatteResolver(const AovSources& sources)
        : ids_(*sources.ids), objects_(sources, false), materials_(sources, true) {}
    void begin(int, int) override { objects_.begin(0, 0), materials_.begin(0, 0); }
    void miss(const glm::vec3& c) override { objects_.miss(c), materials_.miss(c); }
    void hit(const SurfaceSample& s, const glm::vec3& c) override { objects_.hit(s, c), materials_.hit(s, c); }
    void end(float* out) override {
        objects_.rank(ids_.objects, out);
        materials_.rank(ids_.materials, out + 2 * kCryptomatteRanks);
    }

  private:
    struct Ranks : VotingResolver {
        using VotingResolver::VotingResolver;
        void end(float*) override {}
        void rank(const NamedIds& names, float* out) {
            std::fill(out, out + 2 * kCryptomatteRanks, 0.0f);
            int rank = 0;
            for (const Votes::Entry& e : votes_.sorted()) {
                if (e.number == 0) continue;  // the background has no id
                if (rank == kCryptomatteRanks) break;
                out[2 * rank] = names.cryptomatte_id(e.number);
                out[2 * rank + 1] = votes_.share(e);
                ++rank;
            }
        }
    };
    const FrameIds& ids_;
    Ranks objects_, materials_;
};

class CoverageResolver : public AovResolver {
  public:
    void begin(int, int) override { hits_ = samples_ = 0; }
    void hit(const SurfaceSample&, const glm::vec3&) override { ++hits_, ++samples_; }
    void miss(const glm::vec3&) override { ++samples_; }
    void end(float* out) override { *out = static_cast<float>(hits_) / static_cast<float>(samples_); }

  private:
    int hits_ = 0, samples_ = 0;
};

// Welford's sums: no cancellation where a pixel is bright and even.
class VarianceResolver : public AovResolver {
  public:
    explicit VarianceResolver(const AovSources& sources) : brightness_(sources.brightness) {}
    void begin(int, int) override {
        mean_ = squares_ = glm::dvec3(0.0);
        count_ = 0;
    }
    void hit(const SurfaceSample&, const glm::vec3& color) override { add(color); }
    void miss(const glm::vec3& background) override { add(background); }
    void end(float* out) override {
        const double divisor = count_ > 1 ? double(count_ - 1) * count_ : 1.0;
        for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(squares_[c] / divisor * brightness_ * brightness_);
    }

  private:
    void add(const glm::vec3& color) {
        ++count_;
        const glm::dvec3 off = glm::dvec3(color) - mean_;
        mean_ += off / double(count_);
        squares_ += off * (glm::dvec3(color) - mean_);
    }
    double brightness_;
    glm::dvec3 mean_{0.0}, squares_{0.0};
    int count_ = 0;
};

// The texture at the point itself: the samples average over pixel, motion and lens themselves.
class AlbedoResolver : public MeanResolver<3> {
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        const BoundMaterial& bound = *s.shaded->material;
        const Primitive& primitive = *s.shaded->primitive;
        glm::vec3 base(bound.material.base_color);
        if (bound.base_color.pyramid) {
            const std::vector<glm::vec2>& uvs = primitive.texcoords[bound.base_color.set];
            base *= glm::vec3(bound.base_color.sample(uvs.empty() ? glm::vec2(0.0f) : interpolate(uvs, s), {}));
        }
        if (!primitive.colors.empty()) base *= glm::vec3(interpolate(primitive.colors, s));
        add({base.x, base.y, base.z});
    }
};

class OcclusionResolver : public MeanResolver<4> {
  public:
    explicit OcclusionResolver(const AovSources& sources) : occlusion_(*sources.occlusion) {}
    void hit(const SurfaceSample& s, const glm::vec3&) override {
        using Fate = FlowOcclusion::Fate;
        const auto is = [](Fate fate, Fate wanted) { return fate == wanted ? 1.0 : 0.0; };
        const Fate later = occlusion_.forward(s), earlier = occlusion_.backward(s);
        add({is(later, Fate::kHidden), is(later, Fate::kOutside), is(earlier, Fate::kHidden),
             is(earlier, Fate::kOutside)});
    }

  private:
    const FlowOcclusion& occlusion_;
};

class SamplesResolver : public AovResolver {
  public:
    void begin(int, int) override { samples_ = 0; }
    void hit(const SurfaceSample&, const glm::vec3&) override { ++samples_; }
    void miss(const glm::vec3&) override { ++samples_; }
    void end(float* out) override { *out = static_cast<float>(samples_); }

  private:
    int samples_ = 0;
};

class SteResolver : public AovResolver {
  public:
    explicit SteResolver(const AovSources& sources) : tests_(*sources.tests) {}
    void begin(int px, int py) override { pixel_ = static_cast<std::size_t>(py) * tests_.width + px; }
    void hit(const SurfaceSample&, const glm::vec3&) override {}
    void miss(const glm::vec3&) override {}
    void end(float* out) override {
        const auto tested = static_cast<float>(tests_.tested[pixel_]);
        out[0] = tested > 0.0f ? static_cast<float>(tests_.covered[pixel_]) / tested : 0.0f;
        out[1] = tested;
    }

  private:
    const CoverMap& tests_;
    std::size_t pixel_ = 0;
};

}  // namespace

std::unique_ptr<AovResolver> make_resolver(Aov aov, const AovSources& sources) {
    switch (aov) {
        case Aov::kDepth:
            return std::make_unique<DepthResolver>();
        case Aov::kNormal:
            return std::make_unique<NormalResolver>();
        case Aov::kPosition:
            return std::make_unique<PositionResolver>(sources);
        case Aov::kUv:
            return std::make_unique<UvResolver>();
        case Aov::kMotion:
            return std::make_unique<MotionResolver>(sources);
        case Aov::kCoc:
            return std::make_unique<CocResolver>();
        case Aov::kTime:
            return std::make_unique<TimeResolver>(sources, false);
        case Aov::kObjectId:
            return std::make_unique<IdResolver>(sources, false);
        case Aov::kMaterialId:
            return std::make_unique<IdResolver>(sources, true);
        case Aov::kCryptomatte:
            return std::make_unique<CryptomatteResolver>(sources);
        case Aov::kCoverage:
            return std::make_unique<CoverageResolver>();
        case Aov::kAlbedo:
            return std::make_unique<AlbedoResolver>();
        case Aov::kOcclusion:
            return std::make_unique<OcclusionResolver>(sources);
        case Aov::kSte:
            return std::make_unique<SteResolver>(sources);
        case Aov::kSamples:
            return std::make_unique<SamplesResolver>();
        case Aov::kVariance:
            break;
    }
    return std::make_unique<VarianceResolver>(sources);
}

}  // namespace pentaprism
