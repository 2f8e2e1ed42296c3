#include "correspondence/stereo_points.h"

#include "core/statistics.h"
#include "geometry/triangulation.h"

namespace rigmap {

std::vector<NormalisedFeature> NormaliseFeatures(const std::vector<Feature>& features,
                                                 const StereoRig& rig) {
  std::vector<NormalisedFeature> result;
  for (const Feature& feature : features) {
    NormalisedFeature& normalised = result.emplace_back();
    normalised.left = Undistort(rig.left.camera, feature.left);
    if (feature.right) normalised.right = Undistort(rig.right.camera, *feature.right);
  }
  return result;
}

std::vector<std::optional<StereoPoint>> TriangulateFeatures(const std::vector<Feature>& features,
                                                            const StereoRig& rig,
                                                            double disparity_noise_px) {
  const double metres_per_square_metre =
      disparity_noise_px / (rig.left.camera.MeanFocal() * rig.Baseline());
  std::vector<std::optional<StereoPoint>> points;
  for (const NormalisedFeature& feature : NormaliseFeatures(features, rig)) {
    auto& point = points.emplace_back();
    if (!feature.left || !feature.right) continue;
    const auto x = TriangulateStereo(rig.right_from_left, *feature.left, *feature.right);
    if (x) point = StereoPoint{*x, metres_per_square_metre * x->z() * x->norm()};
  }
  return points;
}

std::optional<double> NearDepth(const std::vector<Feature>& features, const StereoRig& rig) {
  constexpr std::size_t kFewest = 20;
  constexpr double kNearer = 0.05,
                   kAnyNoise_px = 0.1;  // the latter for sigmas that nobody asks for
  std::vector<double> depths_m;
  for (const auto& point : TriangulateFeatures(features, rig, kAnyNoise_px)) {
    if (point && point->x_in_left.z() > 0.0) depths_m.push_back(point->x_in_left.z());
  }
  if (depths_m.size() < kFewest) return std::nullopt;
  return Quantile(std::move(depths_m), kNearer);
}

}  // namespace rigmap
