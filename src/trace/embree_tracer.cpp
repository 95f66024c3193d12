#include "trace/embree_tracer.h"

#include <cmath>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <map>
#include <pentaprism/error.h>
#include <tuple>
#include <vector>

#include "base/aligned.h"
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
    std::uint32_t part = 0;  // only where each is a geometry
    bool operator<(const GroupKey& other) const {
        return std::tie(knots, asks, part) < std::tie(other.knots, other.asks, other.part);
    }
};

RTCBuildQuality quality(EmbreeBuild build) {
    switch (build) {
        case EmbreeBuild::kLow:
            return RTC_BUILD_QUALITY_LOW;
        case EmbreeBuild::kHigh:
            return RTC_BUILD_QUALITY_HIGH;
        case EmbreeBuild::kMedium:
            break;
    }
    return RTC_BUILD_QUALITY_MEDIUM;
}

struct Group {
    std::vector<std::uint32_t> parts;
    std::vector<std::uint32_t> triangles;  // of the frame, by Embree's primitive
    bool asks = false;                     // one-sided or not opaque: every hit needs a look
    int knots = 1;
    RTCGeometry geometry = nullptr;  // the scene's
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
        : frame_(frame),
          table_(table),
          scale_(axis_scale(frame.view)),
          for_speed_(options.for_speed),
          quick_lines_(options.for_speed && frame.view.lens.tilt == glm::dvec2(0.0)),
          coherent_(options.coherent),
          rays_(options.rays) {
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

    void refit() {
        for (Group& group : groups_) {
            if (group.triangles.empty()) continue;
            rtcSetGeometryBuildQuality(group.geometry, RTC_BUILD_QUALITY_REFIT);
            for (int knot = 0; knot < group.knots; ++knot) {
                const auto slot = static_cast<unsigned>(knot);
                fill_vertices(
                    group, knot,
                    static_cast<Point3*>(rtcGetGeometryBufferData(group.geometry, RTC_BUFFER_TYPE_VERTEX, slot)));
                rtcUpdateGeometryBuffer(group.geometry, RTC_BUFFER_TYPE_VERTEX, slot);
            }
            rtcCommitGeometry(group.geometry);
        }
        rtcCommitScene(scene_);
        check(device_);
    }

  private:
    /// What the filter needs to know of a packet beside the rays.
    struct Context : RTCIntersectContext {
        const Impl* self;
        const SampleVector* vectors;  // of the block; a ray's id is its lane in these
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
        int flags = RTC_SCENE_FLAG_NONE;
        if (!options.for_speed || options.robust_speed) flags |= RTC_SCENE_FLAG_ROBUST;
        if (options.dynamic) flags |= RTC_SCENE_FLAG_DYNAMIC;
        rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(flags));
        rtcSetSceneBuildQuality(scene_, quality(options.build));
        std::map<GroupKey, Group> groups;
        int most_knots = 1;
        for (const Part& part : frame_.parts)
            if (part.moves) most_knots = std::max(most_knots, part.segments + 1);
        for (std::uint32_t i = 0; i < frame_.parts.size(); ++i) {
            const Part& part = frame_.parts[i];
            const int knots = part.moves ? part.segments + 1 : 1;
            if (knots > kMaxSegments + 1) {
                throw Error(ErrorKind::kBackend, fmt::format("Embree traces at most {} motion segments, not {}; lower "
                                                             "--motion-segments",
                                                             kMaxSegments, part.segments));
            }
            const bool asks = (!part.two_sided && !for_speed_) || part.alpha_mode != AlphaMode::kOpaque;
            GroupKey key{knots, asks};
            if (options.layout == EmbreeLayout::kTogether && !part.moves) key.knots = most_knots;
            if (options.layout == EmbreeLayout::kParts) key.part = i;
            Group& group = groups[key];
            group.asks = asks;
            group.knots = key.knots;
            group.parts.push_back(i);
        }
        groups_.reserve(groups.size());  // geometries keep pointers to them
        for (auto& [key, group] : groups) {
            groups_.push_back(std::move(group));
            attach(groups_.back(), options);
        }
        rtcCommitScene(scene_);
        check(device_);
    }

    void attach(Group& group, const EmbreeOptions& options) {
        const int knots = group.knots;
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        group.geometry = geometry;
        rtcSetGeometryBuildQuality(geometry, quality(options.build));
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
            const std::size_t first =
                part.first_point + (part.moves ? static_cast<std::size_t>(knot) * part.vertex_count : 0);
            for (std::uint32_t v = 0; v < part.vertex_count; ++v) {
                const glm::vec4& p = frame_.points[first + v];
                const float z = frame_.view.perspective ? p.z : frame_.depths[first + v];
                *out++ = {p.x * scale_, p.y * scale_, z};
            }
        }
    }

    /// Origin + depth * direction, in (x, y); 0 + depth * 1 in z.
    struct Line {
        float origin_x, origin_y, direction_x, direction_y;
    };
    Line line_of(const CellCentre& centre, const SampleVector& samples, int lane) const {
        const LineOfSight line = line_of_sight(frame_.view, centre.x + samples.x[lane], centre.y + samples.y[lane],
                                               samples.u[lane], samples.v[lane]);
        return {static_cast<float>(line.origin.x * scale_), static_cast<float>(line.origin.y * scale_),
                static_cast<float>(line.direction.x * scale_), static_cast<float>(line.direction.y * scale_)};
    }

    /// The rays of a vector from its lane `first` on, as many as the packet holds. `id`: of the first.
    template <class Packet>
    void fill(Packet& packet, int count, const CellCentre& centre, const SampleVector& samples, int first,
              unsigned id) const {
        const float depth_near = static_cast<float>(frame_.view.depth_near),
                    depth_far = static_cast<float>(frame_.view.depth_far);
        if (quick_lines_)
            fill_quickly(packet.ray, count, centre, samples, first);
        else
            for (int k = 0; k < count; ++k) {
                const Line line = line_of(centre, samples, first + k);
                packet.ray.org_x[k] = line.origin_x;
                packet.ray.org_y[k] = line.origin_y;
                packet.ray.dir_x[k] = line.direction_x;
                packet.ray.dir_y[k] = line.direction_y;
            }
        std::fill_n(packet.ray.org_z, count, 0.0f);
        std::fill_n(packet.ray.dir_z, count, 1.0f);
        std::fill_n(packet.ray.tnear, count, depth_near);
        std::fill_n(packet.ray.tfar, count, depth_far);
        std::copy_n(samples.t + first, count, packet.ray.time);
        std::fill_n(packet.ray.mask, count, 0xffffffffu);
        for (int k = 0; k < count; ++k) packet.ray.id[k] = id + static_cast<unsigned>(k);
        std::fill_n(packet.ray.flags, count, 0u);
        std::fill_n(packet.hit.geomID, count, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(packet.hit.instID[0], count, RTC_INVALID_GEOMETRY_ID);
    }

    /// line_of() in float, which the compiler makes vectors of: making rays must not count against Embree.
    template <class Rays>
    void fill_quickly(Rays& ray, int count, const CellCentre& centre, const SampleVector& samples, int first) const {
        const float a = static_cast<float>(frame_.view.lens.a) * scale_,
                    b = static_cast<float>(frame_.view.lens.b) * scale_;
        const float to_origin = frame_.view.perspective ? 0.0f : scale_, to_direction = scale_ - to_origin;
        for (int k = 0; k < count; ++k) {
            const float gx = centre.x + samples.x[first + k], gy = centre.y + samples.y[first + k];
            const float u = samples.u[first + k], v = samples.v[first + k];
            ray.org_x[k] = gx * to_origin - a * u;
            ray.org_y[k] = gy * to_origin - a * v;
            ray.dir_x[k] = gx * to_direction - b * u;
            ray.dir_y[k] = gy * to_direction - b * v;
        }
    }

    void store(Hits& hits, std::size_t place, unsigned geometry, unsigned primitive, float depth) const {
        if (geometry == RTC_INVALID_GEOMETRY_ID) return;
        hits.depth[place] = depth;
        hits.triangle[place] = groups_[geometry].triangles[primitive];
    }

    template <class Packet>
    void store_packet(Hits& hits, std::size_t place, const Packet& packet, int count, const int* valid) const {
        for (int k = 0; k < count; ++k)
            if (valid[k]) store(hits, place + k, packet.hit.geomID[k], packet.hit.primID[k], packet.ray.tfar[k]);
    }

    /// One block of 4x4 pixels of a tile.
    struct Block {
        CellCentre centre;
        std::span<const SampleVector> vectors;
        std::size_t first;              // of its samples in Hits
        alignas(64) int valid[kLanes];  // lanes in the picture
    };

    template <class Packet, int kCount, class Intersect>
    void trace_packets(const Block& block, Context& context, Hits& hits, Intersect intersect) const {
        alignas(64) Packet packet;
        for (std::size_t slot = 0; slot < block.vectors.size(); ++slot)
            for (int lane = 0; lane < kLanes; lane += kCount) {
                fill(packet, kCount, block.centre, block.vectors[slot], lane,
                     static_cast<unsigned>(slot * kLanes + lane));
                intersect(block.valid + lane, scene_, &context, &packet);
                store_packet(hits, block.first + slot * kLanes + lane, packet, kCount, block.valid + lane);
            }
    }

    void trace_packet_stream(const Block& block, Context& context, Hits& hits) const {
        static thread_local AlignedVector<RTCRayHit16> packets;
        packets.resize(block.vectors.size());
        for (std::size_t slot = 0; slot < packets.size(); ++slot) {
            fill(packets[slot], kLanes, block.centre, block.vectors[slot], 0, static_cast<unsigned>(slot * kLanes));
            for (int lane = 0; lane < kLanes; ++lane)  // a ray that ends before it begins hits nothing
                if (!block.valid[lane]) packets[slot].ray.tfar[lane] = -1.0f;
        }
        rtcIntersectNM(scene_, &context, reinterpret_cast<RTCRayHitN*>(packets.data()), kLanes,
                       static_cast<unsigned>(packets.size()), sizeof(RTCRayHit16));
        for (std::size_t slot = 0; slot < packets.size(); ++slot)
            store_packet(hits, block.first + slot * kLanes, packets[slot], kLanes, block.valid);
    }

    RTCRayHit single(const Block& block, std::size_t slot, int lane) const {
        const SampleVector& s = block.vectors[slot];
        const Line line = line_of(block.centre, s, lane);
        RTCRayHit one{};
        one.ray.org_x = line.origin_x, one.ray.org_y = line.origin_y;
        one.ray.dir_x = line.direction_x, one.ray.dir_y = line.direction_y, one.ray.dir_z = 1.0f;
        // A ray that ends before it begins hits nothing.
        one.ray.tnear = static_cast<float>(frame_.view.depth_near);
        one.ray.tfar = block.valid[lane] ? static_cast<float>(frame_.view.depth_far) : -1.0f;
        one.ray.time = s.t[lane];
        one.ray.mask = 0xffffffffu;
        one.ray.id = static_cast<unsigned>(slot * kLanes + lane);
        one.hit.geomID = one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        return one;
    }

    void trace_singles(const Block& block, Context& context, Hits& hits) const {
        for (std::size_t slot = 0; slot < block.vectors.size(); ++slot)
            for (int lane = 0; lane < kLanes; ++lane) {
                if (!block.valid[lane]) continue;
                alignas(16) RTCRayHit one = single(block, slot, lane);
                rtcIntersect1(scene_, &context, &one);
                store(hits, block.first + slot * kLanes + lane, one.hit.geomID, one.hit.primID, one.ray.tfar);
            }
    }

    void trace_stream(const Block& block, Context& context, Hits& hits) const {
        static thread_local AlignedVector<RTCRayHit> rays;
        rays.clear();
        for (std::size_t slot = 0; slot < block.vectors.size(); ++slot)
            for (int lane = 0; lane < kLanes; ++lane) rays.push_back(single(block, slot, lane));
        rtcIntersect1M(scene_, &context, rays.data(), static_cast<unsigned>(rays.size()), sizeof(RTCRayHit));
        for (std::size_t k = 0; k < rays.size(); ++k)
            store(hits, block.first + k, rays[k].hit.geomID, rays[k].hit.primID, rays[k].ray.tfar);
    }

    void trace_block(const Tile& tile, int bx, int by, Hits& hits) const {
        static thread_local std::vector<SampleVector> room;
        Block block{cell_centre(frame_.view, bx / kCellBlocks, by / kCellBlocks), table_.block(bx, by, room), 0, {}};
        block.first = hits.first(bx, by);
        for (int lane = 0; lane < kLanes; ++lane) {
            const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
            block.valid[lane] = px < tile.x1 && py < tile.y1 ? -1 : 0;
        }
        Context context;
        rtcInitIntersectContext(&context);
        context.flags = coherent_ ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        context.self = this;
        context.vectors = block.vectors.data();
        context.indices = table_.indices(bx, by).data();
        context.bx = bx;
        context.by = by;
        switch (rays_) {
            case EmbreeRays::kPacket16:
                return trace_packets<RTCRayHit16, 16>(block, context, hits, rtcIntersect16);
            case EmbreeRays::kPacket8:
                return trace_packets<RTCRayHit8, 8>(block, context, hits, rtcIntersect8);
            case EmbreeRays::kPacket4:
                return trace_packets<RTCRayHit4, 4>(block, context, hits, rtcIntersect4);
            case EmbreeRays::kSingle:
                return trace_singles(block, context, hits);
            case EmbreeRays::kStream:
                return trace_stream(block, context, hits);
            case EmbreeRays::kPacketStream16:
                return trace_packet_stream(block, context, hits);
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
        return context.self->is_opaque(context, triangle, RTCRayN_id(arguments.ray, n, i));
    }

    static bool is_hit_quick(const Context& context, const RTCFilterFunctionNArguments& arguments, unsigned i,
                             std::uint32_t triangle) {
        const float u = RTCHitN_u(arguments.hit, arguments.N, i), v = RTCHitN_v(arguments.hit, arguments.N, i);
        const float barycentrics[3] = {1.0f - u - v, u, v};
        const unsigned id = RTCRayN_id(arguments.ray, arguments.N, i);
        const int lane = static_cast<int>(id % kLanes);
        return is_opaque_at(context.self->frame_, triangle, barycentrics, context.bx * kBlockSize + lane % kBlockSize,
                            context.by * kBlockSize + lane / kBlockSize, context.indices[id], context.self->table_);
    }

    /// The rule of the coverage stage, at its own barycentrics: a mask's edge is the same edge.
    bool is_opaque(const Context& context, std::uint32_t triangle, unsigned id) const {
        const Part& part = frame_.parts[frame_.part_of[triangle]];
        if (part.alpha_mode == AlphaMode::kOpaque) return true;
        const SampleVector& v = context.vectors[id / kLanes];
        const int lane = static_cast<int>(id % kLanes);
        // In double the product is exact, as the exact test's own is.
        const int segment = part.moves ? static_cast<int>(static_cast<double>(v.t[lane]) * part.segments) : 0;
        const CellCentre centre = cell_centre(frame_.view, context.bx / kCellBlocks, context.by / kCellBlocks);
        const SampleHit hit = project_sample(localize(frame_, triangle, segment, centre),
                                             {v.x[lane], v.y[lane], v.u[lane], v.v[lane], v.t[lane]});
        return is_opaque_at(frame_, triangle, hit.barycentrics, context.bx * kBlockSize + lane % kBlockSize,
                            context.by * kBlockSize + lane / kBlockSize, context.indices[id], table_);
    }

    void release() {
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
    }

    const Frame& frame_;
    const SampleTable& table_;
    float scale_;
    bool for_speed_, quick_lines_, coherent_;
    EmbreeRays rays_;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::vector<Group> groups_;
};

EmbreeTracer::EmbreeTracer(const Frame& frame, const SampleTable& table, const EmbreeOptions& options)
    : impl_(std::make_unique<Impl>(frame, table, options)) {}
EmbreeTracer::~EmbreeTracer() = default;
void EmbreeTracer::refit() {
    impl_->refit();
}
void EmbreeTracer::trace(const Tile& tile, Hits& hits) const {
    impl_->trace(tile, hits);
}

std::string embree_version() {
    return "embree " RTC_VERSION_STRING;
}

}  // namespace pentaprism
