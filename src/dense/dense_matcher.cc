#include "dense/dense_matcher.h"

#include <opencv2/imgproc.hpp>

#include "dense/internal/disparity.h"
#include "dense/internal/refinement.h"
#include "imaging/image.h"

namespace rigmap {

DenseMatcher::DenseMatcher(const StereoRig& rig, const DenseOptions& options,
                           const MaskOptions& mask_options, const cv::Mat& left_mask)
    : rig_(rig),
      options_(options),
      mask_options_(mask_options),
      rectifier_(rig),
      left_static_(StaticMask(rig.left)),
      right_static_(StaticMask(rig.right)) {
  RequireValid(options_);
  RequireValid(mask_options_);
  if (!left_mask.empty()) cv::bitwise_and(left_static_, left_mask, left_static_);
}

DepthMap DenseMatcher::Compute(const StereoFrame& frame) const {
  const cv::Mat colour = ReadColour(frame.left_path, rig_.left.camera, frame.sample_bits);
  const cv::Mat right = ReadGrey(frame.right_path, rig_.right.camera, frame.sample_bits);
  cv::Mat left;
  cv::cvtColor(colour, left, cv::COLOR_BGR2GRAY);
  const RectifiedPair pair{
      rectifier_.RectifyLeft(left), rectifier_.RectifyRight(right),
      rectifier_.RectifyLeftMask(UsableMask(left, left_static_, mask_options_)),
      rectifier_.RectifyRightMask(UsableMask(right, right_static_, mask_options_))};

  DepthMap map;
  map.stamp_ns = frame.stamp_ns;
  map.camera = rectifier_.RectifiedCamera();
  map.left_from_rectified.rotation = rectifier_.LeftFromRectified();
  map.baseline_m = rectifier_.BaselineM();
  map.colour = rectifier_.RectifyLeft(colour);
  const double nearest_px = map.camera.fx * map.baseline_m / options_.min_depth_m;
  const double farthest_px =
      map.camera.fx * map.baseline_m / options_.MaxDepth(map.camera.fx, map.baseline_m);
  const cv::Mat matched = MatchDisparity(pair, nearest_px, options_);
  RefinedDisparity refined = RefineDisparity(pair.left, pair.right, matched, options_);
  map.disparity = std::move(refined.disparity);
  map.disparity_sigma = std::move(refined.sigma);
  // A depth's sigma is z^2 / (f b) sigma_d, with z = f b / d.
  const double most = options_.max_depth_sigma_m / (map.camera.fx * map.baseline_m);
  const cv::Mat unsure = map.disparity_sigma > most * map.disparity.mul(map.disparity);
  map.disparity.setTo(0.0, unsure | (map.disparity < farthest_px) | (map.disparity > nearest_px));
  return map;
}

}  // namespace rigmap
