// SIFT keypoints, spread evenly over the image.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "features/feature_options.h"
#include "scene/features.h"

namespace rigmap {

struct Keypoints {
  std::vector<Eigen::Vector2d> pixels;  // OpenCV's convention; on a blob unbiased, to 0.05 px rms
  std::vector<float> sizes;             // diameter, px
  // As SIFT found them, in the image that was searched.
  std::vector<cv::KeyPoint> found;
  cv::Mat searched;
};

// 2 where images of this size are searched at half resolution, else 1.
int SearchReduction(const cv::Size& size, const FeatureOptions& options);

// Detects on the pixels that `mask` (CV_8UC1, 0 = ignore) leaves of `grey` (CV_8UC1). No two
// keypoints share a place. Deterministic; runs on the calling thread.
Keypoints DetectKeypoints(const cv::Mat& grey, const cv::Mat& mask, const FeatureOptions& options);

// SIFT's descriptors of those that are `chosen` (indices), which is the larger part of its work. It
// doubles the image only where one of these was found in the doubled one, which changes the others'
// a little.
std::vector<Descriptor> Describe(const Keypoints& keypoints,
                                 const std::vector<std::size_t>& chosen);

}  // namespace rigmap
