// The stage `features`: a stereo frame becomes keypoints with descriptors and stereo matches.
#pragma once

#include "features/feature_options.h"
#include "imaging/mask.h"
#include "scene/dataset.h"
#include "scene/features.h"
#include "scene/sampled_features.h"

namespace rigmap {

// What every frame of a rig shares.
struct FeatureSetup {
  StereoRig rig;
  cv::Mat left_mask, right_mask;  // static masks, CV_8UC1, 0 = ignore
  FeatureOptions options;
  MaskOptions mask_options;
};

// Reads the mask files that the rig names.
FeatureSetup MakeFeatureSetup(const StereoRig& rig, const FeatureOptions& options,
                              const MaskOptions& mask_options);

// Reads both images and finds their features; about 0.1 s for a 1024 x 768 pair on one core.
// Deterministic; may run for several frames at once. A frame of which an image cannot be decoded
// has no features and names the file; throws DataError if one is missing or not of the rig's size.
FrameFeatures ExtractFeatures(const StereoFrame& frame, const FeatureSetup& setup);

// Features at these pixels of the left image as ExtractFeatures would make them, without
// descriptors: an entry each, nothing outside the image and where it is masked. No entries for a
// frame of which an image cannot be decoded; throws DataError as above.
std::vector<std::optional<SampledFeature>> SampleFeatures(
    const StereoFrame& frame, const std::vector<Eigen::Vector2d>& pixels,
    const FeatureSetup& setup);

// Keypoints with descriptors of one eye's image alone, as `left` of its features, without patches.
// None of one that cannot be decoded; throws DataError as above.
FrameFeatures ExtractLoneFeatures(const LoneImage& image, int sample_bits,
                                  const FeatureSetup& setup);

}  // namespace rigmap
