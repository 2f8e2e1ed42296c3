// SIFT keypoints, spread evenly over the image.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "features/feature_options.h"
#include "scene/features.h"

namespace rigmap {

struct Keypoints {
  std::vector<Eigen::Vector2d> pixels;  // OpenCV's convention; on a blob unbiased, to 0.05 px rms
  std::vector<float> sizes;             // diameter, px
  std::vector<Descriptor> descriptors;
};

// 2 where images of this size are searched at half resolution, else 1.
int SearchReduction(const cv::Size& size, const FeatureOptions& options);

// Detects on the pixels that `mask` (CV_8UC1, 0 = ignore) leaves of `grey` (CV_8UC1). No two
// keypoints share a place. Deterministic; runs on the calling thread.
Keypoints DetectKeypoints(const cv::Mat& grey, const cv::Mat& mask, const FeatureOptions& options);

}  // namespace rigmap
