#include "features/extract_features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "features/keypoints.h"
#include "features/stereo_matches.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

// A little blur makes bilinear interpolation unbiased to 0.01 px and takes the sensor's noise.
cv::Mat Smooth(const cv::Mat& grey) {
  constexpr double kSigmaPx = 0.8;
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, cv::Size(5, 5), kSigmaPx);
  return smooth;
}

// Beyond the border the nearest pixel is repeated.
Patch CutPatch(const cv::Mat& grey, const Eigen::Vector2d& centre) {
  // Half pixels are rounded away from zero, as `matching` does that reads the patch.
  const int x0 = static_cast<int>(std::lround(centre.x())) - kPatchRadius;
  const int y0 = static_cast<int>(std::lround(centre.y())) - kPatchRadius;
  Patch patch;
  for (int y = 0; y < kPatchSize; ++y) {
    const std::uint8_t* row = grey.ptr(std::clamp(y0 + y, 0, grey.rows - 1));
    for (int x = 0; x < kPatchSize; ++x) {
      patch[y * kPatchSize + x] = row[std::clamp(x0 + x, 0, grey.cols - 1)];
    }
  }
  return patch;
}

// Empty if the file cannot be decoded; then its name is added to `unreadable`.
cv::Mat ReadIfImage(const StereoFrame& frame, Eye eye, const StereoRig& rig,
                    std::vector<std::string>& unreadable) {
  try {
    return ReadGrey(frame.PathOf(eye), rig.Of(eye).camera, frame.sample_bits);
  } catch (const UnreadableImage&) {
    unreadable.push_back(frame.PathOf(eye));
    return {};
  }
}

}  // namespace

FeatureSetup MakeFeatureSetup(const StereoRig& rig, const FeatureOptions& options,
                              const MaskOptions& mask_options) {
  return {rig, StaticMask(rig.left), StaticMask(rig.right), options, mask_options};
}

FrameFeatures ExtractFeatures(const StereoFrame& frame, const FeatureSetup& setup) {
  FrameFeatures result;
  result.stamp_ns = frame.stamp_ns;
  auto& unreadable = result.unreadable_images;
  const cv::Mat left = ReadIfImage(frame, Eye::kLeft, setup.rig, unreadable);
  const cv::Mat right = ReadIfImage(frame, Eye::kRight, setup.rig, unreadable);
  if (!unreadable.empty()) {
    result.usable_share = 0.0;
    return result;
  }
  const cv::Mat left_mask = UsableMask(left, setup.left_mask, setup.mask_options);
  const Keypoints keypoints = DetectKeypoints(left, left_mask, setup.options);
  const StereoImages images{Smooth(left), Smooth(right),
                            UsableMask(right, setup.right_mask, setup.mask_options)};
  StereoMatches stereo_matches =
      FindStereoMatches(images, setup.rig, keypoints.pixels, setup.options);
  result.descriptors = keypoints.descriptors;
  result.epipolar_errors_px = std::move(stereo_matches.epipolar_errors_px);
  result.usable_share = cv::countNonZero(left_mask) / static_cast<double>(left_mask.total());
  for (std::size_t i = 0; i < keypoints.pixels.size(); ++i) {
    result.features.push_back({keypoints.pixels[i], stereo_matches.right[i], keypoints.sizes[i]});
    result.patches.push_back(CutPatch(images.left, keypoints.pixels[i]));
  }
  return result;
}

}  // namespace rigmap
