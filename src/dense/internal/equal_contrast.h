// Views of cameras that were exposed unlike each other.
#pragma once

#include <opencv2/core.hpp>

namespace rigmap {

// By how much the left view is brighter than the right one: the median ratio of the deciles of
// their usable pixels. 1 where one has hardly any, or is black. Views CV_8UC1, masks CV_8UC1 with 0
// for what is not usable.
double BrightnessRatio(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_mask,
                       const cv::Mat& right_mask);

// Makes the darker view as bright as the other where they differ by more than a shade of the lens
// does: costs of matching are differences of grey values and of their slopes.
void EqualiseContrast(const cv::Mat& left_mask, const cv::Mat& right_mask, cv::Mat& left,
                      cv::Mat& right);

}  // namespace rigmap
