#include "dense/internal/equal_contrast.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kFewest = 1000;  // pixels that tell how bright a view is
// Eyes of one rig are this much alike, shades of the lenses included: within 8 % on four real
// drives, more only where walls stand near one eye.
constexpr double kAlike = 1.15;

// Grey values below which so many tenths of the pixels lie; nothing of too few.
std::vector<double> Deciles(const cv::Mat& view, const cv::Mat& mask) {
  std::array<int, 256> counts{};
  for (int row = 0; row < view.rows; ++row) {
    for (int column = 0; column < view.cols; ++column) {
      if (mask.at<uchar>(row, column) != 0) ++counts[view.at<uchar>(row, column)];
    }
  }
  const int all = std::accumulate(counts.begin(), counts.end(), 0);
  if (all < kFewest) return {};
  std::vector<double> deciles;
  double below = 0.0;
  for (int value = 0; value < 256; ++value) {
    const double next = below + counts[value];
    while (deciles.size() < 9 && next >= 0.1 * (deciles.size() + 1.0) * all) {
      // Within a value as if evenly spread.
      const double share = (0.1 * (deciles.size() + 1.0) * all - below) / counts[value];
      deciles.push_back(value - 0.5 + share);
    }
    below = next;
  }
  return deciles;
}

// By how much the left view is brighter: the median ratio of deciles; 1 where one view has hardly
// any usable pixels, or is black.
double BrightnessRatio(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_mask,
                       const cv::Mat& right_mask) {
  const std::vector<double> of_left = Deciles(left, left_mask),
                            of_right = Deciles(right, right_mask);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(of_left.size(), of_right.size()); ++i) {
    if (of_left[i] > 1.0 && of_right[i] > 1.0) ratios.push_back(of_left[i] / of_right[i]);
  }
  return ratios.empty() ? 1.0 : Median(std::move(ratios));
}

}  // namespace

void EqualiseContrast(const cv::Mat& left_mask, const cv::Mat& right_mask, cv::Mat& left,
                      cv::Mat& right) {
  const double ratio = BrightnessRatio(left, right, left_mask, right_mask);
  if (ratio > kAlike) right.convertTo(right, CV_8U, ratio);
  if (ratio < 1.0 / kAlike) left.convertTo(left, CV_8U, 1.0 / ratio);
}

}  // namespace rigmap
