#include "frame/vertex_paths.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr double kMaxError = 0.1;  // pixels between the true path and its straight pieces
constexpr int kMaxPieces = 64;
constexpr std::size_t kBlock = PointBlock::kSize;
constexpr std::size_t kVerticesAtOnce = 64 * kBlock;  // by one thread

}  // namespace

VertexPaths::Instant::Instant(const Scene& scene, const Placement& placement, const Moment& at)
    : moment(at), vertices(scene, at.pose, placement), matrix(placement_matrix(scene, at.pose, placement)) {}

VertexPaths::VertexPaths(const Scene& scene, const View& view, const Placement& placement, Moments& moments)
    : scene_(scene),
      view_(view),
      placement_(placement),
      moments_(moments),
      primitive_(scene.meshes[placement.mesh].primitives[placement.primitive]),
      rigid_(is_rigid(scene, placement)),
      kernels_(clip_kernels()) {}

const VertexPaths::Instant& VertexPaths::at(double t) {
    const auto found = instants_.find(t);
    if (found != instants_.end()) return found->second;
    return instants_.try_emplace(t, scene_, placement_, moments_.at(t)).first->second;
}

std::vector<const VertexPaths::Instant*> VertexPaths::at_quarters(int pieces) {
    moments_.make(4 * pieces);
    std::vector<const Instant*> times;
    for (int i = 0; i <= 4 * pieces; ++i) times.push_back(&at(i / (4.0 * pieces)));
    return times;
}

// The primitive's own; the last block is filled up with the last vertex.
PointBlock VertexPaths::positions(std::size_t first) const {
    PointBlock block;
    for (std::size_t i = 0; i < kBlock; ++i) {
        const glm::vec3& p = primitive_.positions[std::min(first + i, primitive_.positions.size() - 1)];
        block.x[i] = p.x, block.y[i] = p.y, block.z[i] = p.z;
    }
    return block;
}

void VertexPaths::compute(const Instant& instant, std::size_t first, const PointBlock& local, ClipBlock& out) const {
    PointBlock world;
    if (rigid_) {
        kernels_.transform(instant.matrix, local, world);
    } else {
        const std::size_t count = std::min(kBlock, primitive_.positions.size() - first);
        glm::dvec3 positions[kBlock];
        instant.vertices.positions(first, std::span(positions, count));
        for (std::size_t i = 0; i < kBlock; ++i) {
            const glm::dvec3& p = positions[std::min(i, count - 1)];
            world.x[i] = p.x, world.y[i] = p.y, world.z[i] = p.z;
        }
    }
    kernels_.to_clip(instant.moment.view, instant.moment.to_camera, world, out);
}

template <class Body>
void VertexPaths::for_each_block(const Body& body) const {
    parallel_ranges(primitive_.positions.size(), kVerticesAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += kBlock) body(first);
    });
}

bool VertexPaths::stand_still() {
    const std::vector<const Instant*> times = at_quarters(1);
    const auto same_place = [&](const Instant* other) {
        return other->matrix == times[0]->matrix && other->moment.to_camera == times[0]->moment.to_camera;
    };
    if (rigid_ && !view_.optics_move && std::all_of(times.begin(), times.end(), same_place)) return true;
    std::atomic<bool> still = true;
    for_each_block([&](std::size_t first) {
        if (!still) return;
        const PointBlock local = positions(first);
        ClipBlock at_first, later;
        compute(*times[0], first, local, at_first);
        for (std::size_t i = 1; i < times.size() && still; ++i) {
            compute(*times[i], first, local, later);
            if (!kernels_.is_equal(at_first, later)) still = false;
        }
    });
    return still;
}

void VertexPaths::make_room(std::size_t knot_count, KnotVertices& knots) const {
    knots.points.clear();  // what fewer pieces left is not copied
    knots.points.resize(knot_count * primitive_.positions.size());
    if (!view_.perspective) knots.depths.resize(knots.points.size());
}

void VertexPaths::store(const ClipBlock& block, std::size_t first, std::size_t knot, KnotVertices& knots) const {
    const std::size_t n = primitive_.positions.size(), count = std::min(kBlock, n - first);
    glm::vec4* points = &knots.points[knot * n + first];
    for (std::size_t i = 0; i < count; ++i)
        points[i] = {static_cast<float>(block.x[i]), static_cast<float>(block.y[i]), static_cast<float>(block.w[i]),
                     static_cast<float>(block.c[i])};
    if (view_.perspective) return;
    for (std::size_t i = 0; i < count; ++i) knots.depths[knot * n + first + i] = static_cast<float>(block.z[i]);
}

// Whether so many pieces are straight enough for a block. If not, its knots have no meaning.
bool VertexPaths::follow(const std::vector<const Instant*>& times, std::size_t first, KnotVertices& knots) const {
    const PointBlock local = positions(first);
    ClipBlock ends[2], between;
    compute(*times[0], first, local, ends[0]);
    store(ends[0], first, 0, knots);
    for (std::size_t k = 0; 4 * k + 4 < times.size(); ++k) {
        const ClipBlock& from = ends[k % 2];
        ClipBlock& to = ends[1 - k % 2];
        compute(*times[4 * k + 4], first, local, to);
        store(to, first, k + 1, knots);
        for (int quarter = 1; quarter < 4; ++quarter) {
            compute(*times[4 * k + quarter], first, local, between);
            if (kernels_.path_error(view_, from, to, between, 0.25 * quarter) > kMaxError) return false;
        }
    }
    return true;
}

int VertexPaths::straight_pieces(KnotVertices& knots) {
    std::atomic<std::size_t> bent = 0;  // the last block found that needed more pieces: likely to need more again
    for (int pieces = 1; pieces < kMaxPieces; pieces *= 2) {
        const std::vector<const Instant*> times = at_quarters(pieces);
        make_room(static_cast<std::size_t>(pieces) + 1, knots);
        if (!follow(times, bent, knots)) continue;
        std::atomic<bool> straight = true;
        for_each_block([&](std::size_t first) {
            if (!straight || follow(times, first, knots)) return;
            straight = false;
            bent = first;
        });
        if (straight) return pieces;
    }
    at_knots(kMaxPieces, knots);
    return kMaxPieces;
}

void VertexPaths::at_knots(int pieces, KnotVertices& knots) {
    std::vector<const Instant*> times;
    for (int k = 0; k <= pieces; ++k) times.push_back(&at(pieces == 0 ? 0.0 : static_cast<double>(k) / pieces));
    make_room(times.size(), knots);
    for_each_block([&](std::size_t first) {
        const PointBlock local = positions(first);
        ClipBlock block;
        for (std::size_t k = 0; k < times.size(); ++k) {
            compute(*times[k], first, local, block);
            store(block, first, k, knots);
        }
    });
}

}  // namespace pentaprism
