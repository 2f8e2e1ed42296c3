#include "features/extract_features.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

// All but the faint ones that not even the other eye shows: few of them are found again in another
// frame (one in eight in a sand yard), and to describe a keypoint is most of its work.
std::vector<std::size_t> WorthDescribing(const Keypoints& keypoints, const StereoMatches& matches,
                                         double contrast_threshold) {
  std::vector<std::size_t> worth;
  for (std::size_t i = 0; i < keypoints.found.size(); ++i) {
    if (matches.found[i] || keypoints.found[i].response >= contrast_threshold) worth.push_back(i);
  }
  return worth;
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
  result.epipolar_errors_px = std::move(stereo_matches.epipolar_errors_px);
  result.usable_share = cv::countNonZero(left_mask) / static_cast<double>(left_mask.total());
  const std::vector<std::size_t> chosen =
      WorthDescribing(keypoints, stereo_matches, setup.options.contrast_threshold);
  for (const std::size_t i : chosen) {
    result.features.push_back(
        FeatureOf(keypoints.pixels[i], stereo_matches.found[i], keypoints.sizes[i]));
    result.patches.push_back(CutPatch(images.left, keypoints.pixels[i]));
  }
  result.descriptors = Describe(keypoints, chosen);
  return result;
}

std::vector<std::optional<SampledFeature>> SampleFeatures(
    const StereoFrame& frame, const std::vector<Eigen::Vector2d>& pixels,
    const FeatureSetup& setup) {
  std::vector<std::string> unreadable;
  const auto pair = ReadGreyPair(frame, setup.rig, unreadable);
  if (!pair) return {};
  const StereoImages images{Smooth(pair->left), Smooth(pair->right),
                            UsableMask(pair->right, setup.right_mask, setup.mask_options)};
  const StereoMatches matches = FindStereoMatches(images, setup.rig, pixels, setup.options);
  const cv::Mat mask = UsableMask(pair->left, setup.left_mask, setup.mask_options);
  std::vector<std::optional<SampledFeature>> sampled(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point pixel(cvRound(pixels[i].x()), cvRound(pixels[i].y()));
    if (!cv::Rect({}, mask.size()).contains(pixel) || mask.at<std::uint8_t>(pixel) == 0) continue;
    sampled[i] = {FeatureOf(pixels[i], matches.found[i], kPatchSize),
                  CutPatch(images.left, pixels[i])};
  }
  return sampled;
}

FrameFeatures ExtractLoneFeatures(const LoneImage& image, int sample_bits,
                                  const FeatureSetup& setup) {
  FrameFeatures result;
  result.stamp_ns = image.stamp_ns;
  try {
    const cv::Mat grey = ReadGrey(image.path, setup.rig.Of(image.eye).camera, sample_bits);
    const cv::Mat& mask = image.eye == Eye::kLeft ? setup.left_mask : setup.right_mask;
    const Keypoints keypoints =
        DetectKeypoints(grey, UsableMask(grey, mask, setup.mask_options), setup.options);
    std::vector<std::size_t> all(keypoints.pixels.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    result.descriptors = Describe(keypoints, all);
    for (const std::size_t i : all) {
      result.features.push_back({keypoints.pixels[i], std::nullopt, keypoints.sizes[i]});
    }
  } catch (const UnreadableImage&) {
    result.unreadable_images.push_back(image.path);
  }
  return result;
}

}  // namespace rigmap
