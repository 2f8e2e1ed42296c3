// Points of one stereo frame.
#pragma once

#include <optional>
#include <vector>

#include "scene/features.h"
#include "scene/rig.h"

namespace rigmap {

struct StereoPoint {
  Eigen::Vector3d x_in_left;   // metres
  double depth_sigma_m = 0.0;  // along the line of sight
};

// One entry per feature; nothing where it has no stereo match or the rays do not meet in front. The
// sigma is z |x| / (f b) times disparity_noise_px: that of the depth, z^2 / (f b), along the ray.
std::vector<std::optional<StereoPoint>> TriangulateFeatures(const std::vector<Feature>& features,
                                                            const StereoRig& rig,
                                                            double disparity_noise_px);

// Depth of near ground in one frame, along the left camera's axis: a twentieth of its stereo points
// are nearer. Nothing of fewer than twenty.
std::optional<double> NearDepth(const std::vector<Feature>& features, const StereoRig& rig);

// Undistorted normalised coordinates of each feature's left and right pixel.
struct NormalisedFeature {
  std::optional<Eigen::Vector2d> left, right;
};
std::vector<NormalisedFeature> NormaliseFeatures(const std::vector<Feature>& features,
                                                 const StereoRig& rig);

}  // namespace rigmap
