// Views of cameras that were exposed unlike each other.
#pragma once

#include <opencv2/core.hpp>

namespace rigmap {

// Makes the darker view as bright as the other where they differ by more than a shade of the lens
// does: costs of matching are differences of grey values and of their slopes. How bright they are
// tell the deciles of their usable pixels. Views CV_8UC1, masks CV_8UC1 with 0 for what is not
// usable.
void EqualiseContrast(const cv::Mat& left_mask, const cv::Mat& right_mask, cv::Mat& left,
                      cv::Mat& right);

}  // namespace rigmap
