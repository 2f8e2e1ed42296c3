#include "dense/dense_matcher.h"

#include <opencv2/imgproc.hpp>

#include "dense/disparity.h"
#include "imaging/image.h"

namespace rigmap {

DenseMatcher::DenseMatcher(const StereoRig& rig, const DenseOptions& options,
                           const MaskOptions& mask_options)
    : rig_(rig),
      options_(options),
      mask_options_(mask_options),
      rectifier_(rig),
      left_static_(StaticMask(rig.left)),
      right_static_(StaticMask(rig.right)) {
  options_.Validate();
  mask_options_.Validate();
}

DepthMap DenseMatcher::Compute(const StereoFrame& frame) const {
  const cv::Mat colour = ReadColour(frame.left_path, rig_.left.camera);
  const cv::Mat right = ReadGrey(frame.right_path, rig_.right.camera);
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
  map.disparity_sigma_px = options_.disparity_sigma_px;
  map.colour = rectifier_.RectifyLeft(colour);
  const double nearest_px = map.camera.fx * map.baseline_m / options_.min_depth_m;
  const double farthest_px =
      map.camera.fx * map.baseline_m / options_.MaxDepth(map.camera.fx, map.baseline_m);
  map.disparity = MatchDisparity(pair, nearest_px, options_);
  map.disparity.setTo(0.0, (map.disparity < farthest_px) | (map.disparity > nearest_px));
  return map;
}

}  // namespace rigmap
