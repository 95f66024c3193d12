#pragma once
// The scene and the camera at times of the shutter, each evaluated once.

#include <atomic>
#include <map>
#include <mutex>
#include <span>

#include "base/parallel.h"
#include "camera/view.h"
#include "scene/pose.h"

namespace pentaprism {

struct Moment {
    Pose pose;
    glm::dmat4 to_camera;
    View view;
};

/// Moments by shutter time, 0 to 1, made when first asked for; from any thread, different ones at the same time. Refers
/// to the scene and the clips.
class Moments {
  public:
    Moments(const Scene& scene, const View& view, std::span<const Index> animations)
        : scene_(scene), view_(view), animations_(animations) {}

    const Moment& at(double t) {
        Entry& entry = entry_of(t);
        std::call_once(entry.made, [&] {
            Moment& moment = entry.moment;
            moment.pose = evaluate(scene_, animations_, view_.shutter.at(t));
            moment.to_camera = world_to_camera(view_, moment.pose);
            moment.view = view_at(scene_, view_, moment.pose);
        });
        return entry.moment;
    }

    /// Makes those at i / parts of the shutter, by all threads: a scene of many nodes takes a millisecond for each.
    void make(int parts) {
        if (parts <= made_.load()) return;  // parts are powers of two: more of them include fewer
        parallel_for(static_cast<std::size_t>(parts) + 1, [&](std::size_t i) { at(static_cast<double>(i) / parts); });
        made_ = parts;
    }

  private:
    struct Entry {
        std::once_flag made;
        Moment moment;
    };
    Entry& entry_of(double t) {
        const std::lock_guard<std::mutex> lock(mutex_);
        return moments_[t];
    }

    const Scene& scene_;
    View view_;
    std::span<const Index> animations_;
    std::mutex mutex_;
    std::map<double, Entry> moments_;
    std::atomic<int> made_ = 0;  // the most parts that make() was called with
};

}  // namespace pentaprism
