#include "trace/embree_tracer.h"

#include <cmath>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <map>
#include <pentaprism/error.h>
#include <vector>

#include "base/parallel.h"
#include "bound/local_triangle.h"
#include "cover/exact.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

constexpr int kMaxSegments = RTC_MAX_TIME_STEP_COUNT - 1;
constexpr float kLargest = 1e12f;  // a triangle with a coordinate beyond this is dropped (frame/frame.h)

/// Parts that share the number of knots and the need to ask at each hit become one geometry of Embree: few large
/// geometries trace faster than many small ones, and what stands still stays out of the motion-blur hierarchy.
struct GroupKey {
    int knots;
    bool asks;
    bool operator<(const GroupKey& other) const {
        return knots != other.knots ? knots < other.knots : asks < other.asks;
    }
};

struct Group {
    std::vector<std::uint32_t> parts;
    std::vector<std::uint32_t> triangles;  // of the frame, by Embree's primitive
    bool asks = false;                     // one-sided or not opaque: every hit needs a look
};

struct Point3 {
    float x, y, z;
};

void check(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
        throw Error(
            ErrorKind::kBackend,
            fmt::format("Embree refuses this frame (error {}); render without the reference", static_cast<int>(error)));
    }
}

bool can_be_trusted(const Frame& frame, const Part& part, std::uint32_t triangle) {
    const int knots = part.moves ? part.segments + 1 : 1;
    for (int i = 0; i < 3; ++i) {
        for (int knot = 0; knot < knots; ++knot) {
            const glm::vec4& p = frame.points[frame.corners[3 * std::size_t{triangle} + i] +
                                              static_cast<std::size_t>(knot) * part.vertex_count];
            for (int k = 0; k < 4; ++k) {
                if (!(std::abs(p[k]) <= kLargest)) return false;
            }
        }
    }
    return true;
}

/// A power of two that brings pixels times metres near metres: Embree's error bounds assume axes of one scale. Exact.
float axis_scale(const View& view) {
    return static_cast<float>(std::exp2(-std::round(std::log2(std::max(view.fx, 1e-6)))));
}

}  // namespace

class EmbreeTracer::Impl {
  public:
    Impl(const Frame& frame, const SampleTable& table, const EmbreeOptions& options)
        : frame_(frame), table_(table), scale_(axis_scale(frame.view)), for_speed_(options.for_speed) {
        const std::string configuration =
            fmt::format("threads={}{}{}", thread_count(), options.device.empty() ? "" : ",", options.device);
        device_ = rtcNewDevice(configuration.c_str());
        if (!device_) {
            throw Error(ErrorKind::kBackend, fmt::format("Embree cannot start with '{}'", configuration));
        }
        try {
            build(options);
        } catch (...) {
            release();
            throw;
        }
    }
    ~Impl() { release(); }

    void trace(const Tile& tile, Hits& hits) const {
        for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by) {
            for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) trace_block(tile, bx, by, hits);
        }
    }

  private:
    /// What the filter needs to know of a packet beside the rays.
    struct Context : RTCIntersectContext {
        const Impl* self;
        const SampleVector* vector;
        const std::uint16_t* indices;
        int bx, by;
    };

    void build(const EmbreeOptions& options) {
        if (!frame_.view.has_straight_sight()) {
            throw Error(ErrorKind::kBackend,
                        "Embree traces straight rays, which --focus-range, --max-foreground-blur and an animated focus "
                        "or zoom of a lens do not have");
        }
        scene_ = rtcNewScene(device_);
        if (!options.for_speed) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene_, options.fast_build ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
        std::map<GroupKey, Group> groups;
        for (std::uint32_t i = 0; i < frame_.parts.size(); ++i) {
            const Part& part = frame_.parts[i];
            const int knots = part.moves ? part.segments + 1 : 1;
            if (knots > kMaxSegments + 1) {
                throw Error(ErrorKind::kBackend, fmt::format("Embree traces at most {} motion segments, not {}; lower "
                                                             "--motion-segments",
                                                             kMaxSegments, part.segments));
            }
            const bool asks = (!part.two_sided && !for_speed_) || part.alpha_mode != AlphaMode::kOpaque;
            Group& group = groups[{knots, asks}];
            group.asks = asks;
            group.parts.push_back(i);
        }
        groups_.reserve(groups.size());  // geometries keep pointers to them
        for (auto& [key, group] : groups) {
            groups_.push_back(std::move(group));
            attach(groups_.back(), key.knots, options);
        }
        rtcCommitScene(scene_);
        check(device_);
    }

    void attach(Group& group, int knots, const EmbreeOptions& options) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry, options.fast_build ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
        rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(knots));

        std::vector<std::uint32_t> first_vertex;  // of each part in the geometry's buffers
        std::uint32_t vertices = 0;
        std::size_t capacity = 0;
        for (const std::uint32_t i : group.parts) {
            first_vertex.push_back(vertices);
            vertices += frame_.parts[i].vertex_count;
            capacity += frame_.parts[i].triangle_count;
        }
        std::vector<std::uint32_t> corners;
        corners.reserve(3 * capacity);
        group.triangles.reserve(capacity);
        for (std::size_t k = 0; k < group.parts.size(); ++k) {
            const Part& part = frame_.parts[group.parts[k]];
            for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
                if (!can_be_trusted(frame_, part, t)) continue;
                group.triangles.push_back(t);
                for (int i = 0; i < 3; ++i) {
                    corners.push_back(first_vertex[k] + frame_.corners[3 * std::size_t{t} + i] - part.first_point);
                }
            }
        }
        if (!group.triangles.empty()) {
            void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                    3 * sizeof(std::uint32_t), group.triangles.size());
            if (indices) std::copy(corners.begin(), corners.end(), static_cast<std::uint32_t*>(indices));
            for (int knot = 0; knot < knots; ++knot) {
                auto* out = static_cast<Point3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX,
                                                                         static_cast<unsigned>(knot), RTC_FORMAT_FLOAT3,
                                                                         sizeof(Point3), vertices));
                if (out) fill_vertices(group, knot, out);
            }
            rtcSetGeometryUserData(geometry, &group);
            if (group.asks) rtcSetGeometryIntersectFilterFunction(geometry, filter);
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(&group - groups_.data()));
        }
        rtcReleaseGeometry(geometry);
        check(device_);
    }

    void fill_vertices(const Group& group, int knot, Point3* out) const {
        for (const std::uint32_t i : group.parts) {
            const Part& part = frame_.parts[i];
            const std::size_t first = part.first_point + static_cast<std::size_t>(knot) * part.vertex_count;
            for (std::uint32_t v = 0; v < part.vertex_count; ++v) {
                const glm::vec4& p = frame_.points[first + v];
                const float z = frame_.view.perspective ? p.z : frame_.depths[first + v];
                *out++ = {p.x * scale_, p.y * scale_, z};
            }
        }
    }

    /// Sets up the line of sight of one lane: origin + depth * direction.
    void aim(RTCRay16& ray, int lane, double gx, double gy, double u, double v) const {
        const LineOfSight line = line_of_sight(frame_.view, gx, gy, u, v);
        ray.org_x[lane] = static_cast<float>(line.origin.x * scale_);
        ray.org_y[lane] = static_cast<float>(line.origin.y * scale_);
        ray.org_z[lane] = 0.0f;
        ray.dir_x[lane] = static_cast<float>(line.direction.x * scale_);
        ray.dir_y[lane] = static_cast<float>(line.direction.y * scale_);
        ray.dir_z[lane] = 1.0f;
    }

    void trace_block(const Tile& tile, int bx, int by, Hits& hits) const {
        const View& view = frame_.view;
        const CellCentre centre = cell_centre(view, bx / kCellBlocks, by / kCellBlocks);
        const float depth_near = static_cast<float>(view.depth_near), depth_far = static_cast<float>(view.depth_far);
        alignas(64) int valid[kLanes];
        alignas(64) RTCRayHit16 packet;
        for (int lane = 0; lane < kLanes; ++lane) {
            const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
            valid[lane] = px < tile.x1 && py < tile.y1 ? -1 : 0;
        }
        Context context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        context.self = this;
        context.bx = bx;
        context.by = by;

        static thread_local std::vector<SampleVector> room;
        const std::span<const SampleVector> vectors = table_.block(bx, by, room);
        const std::span<const std::uint16_t> indices = table_.indices(bx, by);
        const std::size_t block = kCellBlocks * static_cast<std::size_t>(by % kCellBlocks) + bx % kCellBlocks;
        for (std::size_t slot = 0; slot < vectors.size(); ++slot) {
            const SampleVector& samples = vectors[slot];
            context.vector = &samples;
            context.indices = &indices[slot * kLanes];
            for (int lane = 0; lane < kLanes; ++lane) {
                aim(packet.ray, lane, centre.x + samples.x[lane], centre.y + samples.y[lane], samples.u[lane],
                    samples.v[lane]);
                packet.ray.tnear[lane] = depth_near;
                packet.ray.tfar[lane] = depth_far;
                packet.ray.time[lane] = samples.t[lane];
                packet.ray.mask[lane] = 0xffffffffu;
                packet.ray.id[lane] = static_cast<unsigned>(lane);
                packet.ray.flags[lane] = 0;
                packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
                packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, scene_, &context, &packet);
            const std::size_t first = (block * vectors.size() + slot) * kLanes;
            for (int lane = 0; lane < kLanes; ++lane) {
                if (!valid[lane] || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
                hits.depth[first + lane] = packet.ray.tfar[lane];
                hits.triangle[first + lane] = groups_[packet.hit.geomID[lane]].triangles[packet.hit.primID[lane]];
            }
        }
    }

    /// Refuses back faces of one-sided surfaces and what is cut out. Front: counter-clockwise as seen, which in this
    /// space is a normal along the line of sight (the edge functions' sum is normal . direction).
    static void filter(const RTCFilterFunctionNArguments* arguments) {
        const Group& group = *static_cast<const Group*>(arguments->geometryUserPtr);
        const auto& context = *static_cast<const Context*>(arguments->context);
        const unsigned n = arguments->N;
        for (unsigned i = 0; i < n; ++i) {
            if (arguments->valid[i] != -1) continue;
            const std::uint32_t triangle = group.triangles[RTCHitN_primID(arguments->hit, n, i)];
            const bool hit = context.self->for_speed_ ? is_hit_quick(context, *arguments, i, triangle)
                                                      : is_hit(context, *arguments, i, triangle);
            if (!hit) arguments->valid[i] = 0;
        }
    }

    static bool is_hit(const Context& context, const RTCFilterFunctionNArguments& arguments, unsigned i,
                       std::uint32_t triangle) {
        const Frame& frame = context.self->frame_;
        const unsigned n = arguments.N;
        const bool front = RTCHitN_Ng_x(arguments.hit, n, i) * RTCRayN_dir_x(arguments.ray, n, i) +
                               RTCHitN_Ng_y(arguments.hit, n, i) * RTCRayN_dir_y(arguments.ray, n, i) +
                               RTCHitN_Ng_z(arguments.hit, n, i) * RTCRayN_dir_z(arguments.ray, n, i) >
                           0.0f;
        if (!front && !frame.parts[frame.part_of[triangle]].two_sided) return false;
        return context.self->is_opaque(context, triangle, static_cast<int>(RTCRayN_id(arguments.ray, n, i)));
    }

    static bool is_hit_quick(const Context& context, const RTCFilterFunctionNArguments& arguments, unsigned i,
                             std::uint32_t triangle) {
        const float u = RTCHitN_u(arguments.hit, arguments.N, i), v = RTCHitN_v(arguments.hit, arguments.N, i);
        const float barycentrics[3] = {1.0f - u - v, u, v};
        const int lane = static_cast<int>(RTCRayN_id(arguments.ray, arguments.N, i));
        return is_opaque_at(context.self->frame_, triangle, barycentrics, context.bx * kBlockSize + lane % kBlockSize,
                            context.by * kBlockSize + lane / kBlockSize, context.indices[lane], context.self->table_);
    }

    /// The rule of the coverage stage, at its own barycentrics: a mask's edge is the same edge.
    bool is_opaque(const Context& context, std::uint32_t triangle, int lane) const {
        const Part& part = frame_.parts[frame_.part_of[triangle]];
        if (part.alpha_mode == AlphaMode::kOpaque) return true;
        const SampleVector& v = *context.vector;
        // In double the product is exact, as the exact test's own is.
        const int segment = part.moves ? static_cast<int>(static_cast<double>(v.t[lane]) * part.segments) : 0;
        const CellCentre centre = cell_centre(frame_.view, context.bx / kCellBlocks, context.by / kCellBlocks);
        const SampleHit hit = project_sample(localize(frame_, triangle, segment, centre),
                                             {v.x[lane], v.y[lane], v.u[lane], v.v[lane], v.t[lane]});
        return is_opaque_at(frame_, triangle, hit.barycentrics, context.bx * kBlockSize + lane % kBlockSize,
                            context.by * kBlockSize + lane / kBlockSize, context.indices[lane], table_);
    }

    void release() {
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
    }

    const Frame& frame_;
    const SampleTable& table_;
    float scale_;
    bool for_speed_;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::vector<Group> groups_;
};

EmbreeTracer::EmbreeTracer(const Frame& frame, const SampleTable& table, const EmbreeOptions& options)
    : impl_(std::make_unique<Impl>(frame, table, options)) {}
EmbreeTracer::~EmbreeTracer() = default;
void EmbreeTracer::trace(const Tile& tile, Hits& hits) const {
    impl_->trace(tile, hits);
}

std::string embree_version() {
    return "embree " RTC_VERSION_STRING;
}

}  // namespace pentaprism
