// One pair of images of simulated sand, seen from above and slanted, with what is truly there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "scene/rig.h"
#include "simulation/world.h"

namespace rigmap {

// The left camera is 1.5 m above a beach without boulders, turned 60 degrees down and rolled, so
// that sand 1 to 4 m away fills the images of a rig with a field of view up to 65 degrees. The
// images are 8 bit grey (CV_8UC1), without noise. Sand and images are the same for equal seeds.
class SimulatedShot {
 public:
  SimulatedShot(const StereoRig& rig, std::uint64_t seed);

  const cv::Mat& left() const { return left_; }
  const cv::Mat& right() const { return right_; }

  // Where a ray from the left camera's centre, or of one of its pixels, meets the sand: metres,
  // left camera axes.
  std::optional<Eigen::Vector3d> HitAlong(const Eigen::Vector3d& ray_in_left) const;
  std::optional<Eigen::Vector3d> HitAt(const Eigen::Vector2d& left_pixel) const;

 private:
  Camera camera_;
  World world_;
  Rigid3 world_from_left_;
  cv::Mat left_, right_;
};

}  // namespace rigmap
