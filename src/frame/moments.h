#pragma once
// The scene and the camera at times of the shutter, each evaluated once.

#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "camera/view.h"
#include "scene/pose.h"

namespace pentaprism {

struct Moment {
    Pose pose;
    glm::dmat4 to_camera;
    View view;
};

/// Moments by shutter time, 0 to 1, made when first asked for; from any thread. Refers to the scene and the clips.
class Moments {
  public:
    Moments(const Scene& scene, const View& view, std::span<const Index> animations)
        : scene_(scene), view_(view), animations_(animations) {}

    const Moment& at(double t) {
        const std::lock_guard<std::mutex> lock(mutex_);
        auto& moment = moments_[t];
        if (!moment) {
            moment = std::make_unique<Moment>();
            moment->pose = evaluate(scene_, animations_, view_.shutter.at(t));
            moment->to_camera = world_to_camera(view_, moment->pose);
            moment->view = view_at(scene_, view_, moment->pose);
        }
        return *moment;
    }

  private:
    const Scene& scene_;
    View view_;
    std::span<const Index> animations_;
    std::mutex mutex_;
    std::map<double, std::unique_ptr<Moment>> moments_;
};

}  // namespace pentaprism
