#include "features/extract_features.h"

#include <algorithm>
#include <cmath>

#include "features/internal/grey_pair.h"
#include "features/keypoints.h"
#include "features/stereo_matches.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

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

}  // namespace

FeatureSetup MakeFeatureSetup(const StereoRig& rig, const FeatureOptions& options,
                              const MaskOptions& mask_options) {
  return {rig, StaticMask(rig.left), StaticMask(rig.right), options, mask_options};
}

FrameFeatures ExtractFeatures(const StereoFrame& frame, const FeatureSetup& setup) {
  FrameFeatures result;
  result.stamp_ns = frame.stamp_ns;
  const auto pair = ReadGreyPair(frame, setup.rig, result.unreadable_images);
  if (!pair) {
    result.usable_share = 0.0;
    return result;
  }
  const auto& [left, right] = *pair;
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
    result.features.push_back(
        FeatureOf(keypoints.pixels[i], stereo_matches.found[i], keypoints.sizes[i]));
    result.patches.push_back(CutPatch(images.left, keypoints.pixels[i]));
  }
  return result;
}

FrameFeatures ExtractLoneFeatures(const LoneImage& image, int sample_bits,
                                  const FeatureSetup& setup) {
  FrameFeatures result;
  result.stamp_ns = image.stamp_ns;
  try {
    const cv::Mat grey = ReadGrey(image.path, setup.rig.Of(image.eye).camera, sample_bits);
    const cv::Mat& mask = image.eye == Eye::kLeft ? setup.left_mask : setup.right_mask;
    Keypoints keypoints =
        DetectKeypoints(grey, UsableMask(grey, mask, setup.mask_options), setup.options);
    result.descriptors = std::move(keypoints.descriptors);
    for (std::size_t i = 0; i < keypoints.pixels.size(); ++i) {
      result.features.push_back({keypoints.pixels[i], std::nullopt, keypoints.sizes[i]});
    }
  } catch (const UnreadableImage&) {
    result.unreadable_images.push_back(image.path);
  }
  return result;
}

}  // namespace rigmap
