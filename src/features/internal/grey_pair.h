// The images that features are found in.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

struct GreyPair {
  cv::Mat left, right;  // CV_8UC1
};

// Nothing if one of the files cannot be decoded; the names of such are added to `unreadable`.
std::optional<GreyPair> ReadGreyPair(const StereoFrame& frame, const StereoRig& rig,
                                     std::vector<std::string>& unreadable);

// A little blur makes bilinear interpolation unbiased to 0.01 px and takes the sensor's noise.
cv::Mat Smooth(const cv::Mat& grey);

}  // namespace rigmap
