// What a camera sees of the world: linear radiance per pixel, exact geometry, no sensor yet.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "simulation/moving_bodies.h"
#include "simulation/world.h"

namespace rigmap {

// Draws the views of one camera. Thread-safe; one call uses one thread.
class ViewRenderer {
 public:
  // `world` must outlive this. Throws DataError if the camera's distortion has no inverse somewhere
  // in the image.
  ViewRenderer(const World& world, const Camera& camera);

  // Red, green, blue per pixel (CV_32FC3): sunlit sand is about 0.4. Each pixel is what a
  // lens makes of six rays above each other, with surfaces averaged over what these cover, or of
  // eight all around where edges cross.
  cv::Mat Render(const Rigid3& world_from_camera, std::span<const PosedBody> bodies = {}) const;

 private:
  class View;

  const World& world_;
  Camera camera_;
  std::vector<Eigen::Vector3f> rays_;  // of (width + 2) x (height + 2) pixels, unit, camera axes
};

}  // namespace rigmap
