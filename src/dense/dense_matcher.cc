#include "dense/dense_matcher.h"

#include <opencv2/imgproc.hpp>

#include "dense/internal/disparity.h"
#include "dense/internal/equal_contrast.h"
#include "dense/internal/refinement.h"
#include "dense/internal/silhouettes.h"
#include "imaging/image.h"

namespace rigmap {

DenseMatcher::DenseMatcher(const StereoRig& rig, double nearest_m, const DenseOptions& options,
                           const MaskOptions& mask_options, const cv::Mat& left_mask)
    : rig_(rig),
      nearest_m_(nearest_m),
      options_(options),
      mask_options_(mask_options),
      rectifier_(rig),
      left_static_(StaticMask(rig.left)),
      right_static_(StaticMask(rig.right)) {
  RequireValid(options_);
  RequireValid(mask_options_);
  if (!left_mask.empty()) cv::bitwise_and(left_static_, left_mask, left_static_);
}

DepthMap DenseMatcher::Compute(const StereoFrame& frame, const Eigen::Vector3d& right_turn) const {
  if (right_turn.isZero()) return Compute(frame, rectifier_);
  return Compute(frame, rectifier_.WithRightTurned(right_turn));
}

DepthMap DenseMatcher::Compute(const StereoFrame& frame, const Rectifier& rectifier) const {
  const cv::Mat colour = ReadColour(frame.left_path, rig_.left.camera, frame.sample_bits);
  const cv::Mat right = ReadGrey(frame.right_path, rig_.right.camera, frame.sample_bits);
  cv::Mat left;
  cv::cvtColor(colour, left, cv::COLOR_BGR2GRAY);
  RectifiedPair pair{rectifier.RectifyLeft(left), rectifier.RectifyRight(right),
                     rectifier.RectifyLeftMask(UsableForDepth(left, left_static_)),
                     rectifier.RectifyRightMask(UsableForDepth(right, right_static_))};
  EqualiseContrast(pair.left_mask, pair.right_mask, pair.left, pair.right);

  DepthMap map;
  map.stamp_ns = frame.stamp_ns;
  map.camera = rectifier.RectifiedCamera();
  map.left_from_rectified.rotation = rectifier.LeftFromRectified();
  map.baseline_m = rectifier.BaselineM();
  map.colour = rectifier.RectifyLeft(colour);
  const double depth_px = map.camera.fx * map.baseline_m;  // depth times disparity
  const double nearest_px = NearestPx();
  const double farthest_px = options_.max_range_m > 0.0 ? depth_px / options_.max_range_m : 0.0;
  const cv::Mat matched = MatchDisparity(pair, nearest_px, options_);
  RefinedDisparity refined =
      RefineDisparity(pair.left, pair.right, matched, map.camera.fx, options_);
  map.disparity = std::move(refined.disparity);
  map.disparity_sigma = std::move(refined.sigma);
  map.smoothed_pct = std::move(refined.smoothed_pct);
  const cv::Mat edges = WidenedEdges(pair.left, pair.right, map.disparity, options_);
  map.disparity_sigma.setTo(kUnsurePx, edges);
  // A depth's relative sigma is that of its disparity.
  const cv::Mat unsure = map.disparity_sigma > 0.01 * options_.max_depth_sigma_pct * map.disparity;
  map.disparity.setTo(0.0, unsure | (map.disparity < farthest_px) | (map.disparity > nearest_px));
  return map;
}

cv::Mat DenseMatcher::UsableForDepth(const cv::Mat& grey, const cv::Mat& static_mask) const {
  cv::Mat usable = UsableMask(grey, static_mask, mask_options_);
  // A black area is as good a feature as any; but where a whole block is black nothing is to be
  // matched, and what lies around it would be carried over.
  usable.setTo(0, BlackAreas(grey, mask_options_, options_.block_px));
  return usable;
}

double DenseMatcher::MegabytesPerFrame() const {
  // Both images as read and rectified, in colour and grey, with their masks; then views, masks,
  // what is refined or compared at the edges, the maps of a right eye that has turned, and the
  // result.
  constexpr double kInputBytes = 10.0, kOwnBytes = 78.0;
  const Camera camera = rectifier_.RectifiedCamera();
  const double pixels = static_cast<double>(camera.width) * camera.height;
  const double input_pixels = static_cast<double>(rig_.left.camera.width) * rig_.left.camera.height;
  const double matching =
      static_cast<double>(MatchingBytes({camera.width, camera.height}, NearestPx(), options_));
  return 1e-6 * (kInputBytes * input_pixels + kOwnBytes * pixels + matching);
}

double DenseMatcher::MegabytesPerView() const {
  constexpr double kBytes = 4.0 + 4.0 + 1.0 + 3.0;  // disparity, its sigma, its share, colour
  const Camera camera = rectifier_.RectifiedCamera();
  return 1e-6 * kBytes * camera.width * camera.height;
}

double DenseMatcher::NearestPx() const {
  return rectifier_.RectifiedCamera().fx * rectifier_.BaselineM() / nearest_m_;
}

}  // namespace rigmap
