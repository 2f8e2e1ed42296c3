// Which points of the true surface a stereo camera has seen.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/rigid3.h"
#include "scene/rig.h"
#include "simulation/internal/surface_samples.h"
#include "simulation/world.h"

namespace rigmap {

// A point is seen in a frame if it is 0.4 to 6 m from the left camera, inside both images, faces
// the left camera and nothing stands between; it is visible if at least two frames see it.
class SurfaceVisibility {
 public:
  static constexpr double kMinRange_m = 0.4, kMaxRange_m = 6.0;

  // `world_from_left`: of the frames whose images can be used. `world` must outlive this.
  SurfaceVisibility(const World& world, const StereoRig& rig,
                    std::span<const Rigid3> world_from_left);

  // For each sample whether it is visible. Samples that follow each other should be neighbours:
  // what saw one is asked first about the next. About two rays for each that is visible, one for
  // each frame near it that is not. Thread-safe.
  std::vector<bool> AreVisible(std::span<const SurfaceSample> samples) const;

 private:
  struct View {
    Rigid3 left_from_world, right_from_world;
    Eigen::Vector3d centre_in_world;  // of the left camera
  };
  bool Sees(const View& view, const SurfaceSample& sample) const;
  bool IsVisible(const SurfaceSample& sample, std::vector<const View*>& views) const;

  const World& world_;
  Camera left_, right_;
  std::vector<View> views_;
};

}  // namespace rigmap
