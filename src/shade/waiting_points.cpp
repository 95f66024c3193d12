#include "shade/waiting_points.h"

namespace pentaprism {
namespace {

constexpr int kQuarters = QuarterColors::kQuarters;
constexpr int kLookups = ShadowPoint::kLanes / kQuarters;  // of a quarter
constexpr std::uint32_t kNoTriangleYet = 0xffffffffu;

// Of four bits, how many are set. (The processor's own instruction is a call where the build does not assume it.)
constexpr float kShareOfBits[16] = {0.0f,  0.25f, 0.25f, 0.5f,  0.25f, 0.5f,  0.5f,  0.75f,
                                    0.25f, 0.5f,  0.5f,  0.75f, 0.5f,  0.75f, 0.75f, 1.0f};

}  // namespace

void WaitingPoints::start(const ShadingScene& scene) {
    scene_ = &scene;
    by_quarters_ = scene.shadows().move();
    if (batches_.size() < scene.materials().size()) batches_.resize(scene.materials().size());
}

WaitingPoint& WaitingPoints::add(const BoundMaterial& material, const SurfacePoint& point, TileShade& out) {
    std::unique_ptr<Batch>& place = batches_[&material - scene_->materials().data()];
    if (!place) place = std::make_unique<Batch>();
    if (place->points.count == PointBatch::kLanes) light(*place, out);
    place->points.material = &material;
    const int lane = place->points.count++;
    place->points.set(lane, point);
    WaitingPoint& waiting = place->waiting[lane];
    waiting.shadow.position = point.position;
    return waiting;
}

void WaitingPoints::finish(TileShade& out) {
    for (const std::unique_ptr<Batch>& batch : batches_)
        if (batch && batch->points.count > 0) light(*batch, out);
}

void WaitingPoints::light(Batch& batch, TileShade& out) {
    PointBatch& points = batch.points;
    const bool layered = points.material->layered;
    if (!layered) light_points_.light(*scene_, points, lit_batch_);
    std::uint32_t triangle = kNoTriangleYet;
    for (int lane = 0; lane < points.count; ++lane) {
        WaitingPoint& waiting = batch.waiting[lane];
        if (waiting.triangle != triangle) shadows_.start(scene_->shadows(), waiting.triangle);
        triangle = waiting.triangle;
        if (layered)
            light_point(*scene_, *points.material, points.get(lane), lit_);
        else
            lit_batch_.get(points, lane, lit_);
        write_colors(waiting, out);
    }
    points.count = 0;
}

// What shadows leave of a point's light in each quarter of the shutter that its samples see; where nothing moves one
// colour serves all.
void WaitingPoints::write_colors(WaitingPoint& point, TileShade& out) {
    const QuarterColors& colors = point.colors;
    glm::vec3 color[kQuarters];
    for (glm::vec3& c : color) c = lit_.rest;
    if (!lit_.shadowed.empty()) {
        point.shadow.texel = scene_->shadow_texel(lit_.position);
        point.shadow.quarters = 0;
        for (int q = 0; q < kQuarters; ++q)
            if (!by_quarters_ || colors.color[q] != kBackground) point.shadow.quarters |= 1u << q;
        for (const LitColor::Share& share : lit_.shadowed) {
            point.shadow.offset = share.offset;
            const std::uint32_t lit = shadows_.lit(share.light, point.shadow, point.seed + 8 * share.light);
            float part[kQuarters];
            for (int q = 0; q < kQuarters; ++q) part[q] = kShareOfBits[lit >> kLookups * q & 15u];
            if (!by_quarters_) part[0] = 0.25f * (part[0] + part[1] + part[2] + part[3]);
            for (int q = 0; q < kQuarters; ++q) color[q] += part[q] * share.color;
        }
    }
    for (int q = 0; q < kQuarters; ++q)
        if (colors.color[q] != kBackground) out.colors[colors.color[q]] = contained(color[q]);
}

}  // namespace pentaprism
