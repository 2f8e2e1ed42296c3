#include "dense/internal/disparity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "dense/internal/coarse_to_fine.h"

namespace rigmap {
namespace {

constexpr int kSteps = 16;        // disparities are multiples of 1/16 px
constexpr int kCoarseness = 4;    // reduction at which the range is looked for
constexpr int kCoarseCount = 50;  // coarse pixels that must be as near, to count
constexpr double kRangeMargin = 1.1;

int RoundUpToSixteen(double disparity_px) {
  return std::max(16, 16 * static_cast<int>(std::ceil(disparity_px / 16.0)));
}

// OpenCV matches only left pixels whose whole range of stereo matches lies in the image: both views
// are widened to the left by the range. Result: CV_16S, 1/16 px, not positive where unknown.
cv::Mat MatchBlocks(const cv::Mat& left, const cv::Mat& right, int disparities,
                    const DenseOptions& options) {
  // OpenCV refuses images that are no larger than a block.
  if (std::min(left.rows, left.cols + disparities) <= options.block_px) {
    return cv::Mat(left.size(), CV_16SC1, cv::Scalar(0));
  }
  cv::Mat wide_left, wide_right, wide;
  cv::copyMakeBorder(left, wide_left, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right, wide_right, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  const auto matcher = cv::StereoBM::create(disparities, options.block_px);
  matcher->setUniquenessRatio(options.uniqueness_pct);
  matcher->setDisp12MaxDiff(options.left_right_px);
  matcher->compute(wide_left, wide_right, wide);
  cv::filterSpeckles(wide, 0, options.speckle_size_px, options.speckle_step_px * kSteps);
  return wide.colRange(disparities, wide.cols).clone();
}

// The disparity of the nearest thing seen, with a margin.
double NarrowedRange(const RectifiedPair& pair, double max_disparity_px,
                     const DenseOptions& options) {
  const cv::Size size(pair.left.cols / kCoarseness, pair.left.rows / kCoarseness);
  if (size.width < 32 || size.height < 32) return max_disparity_px;
  cv::Mat left, right, mask;
  cv::resize(pair.left, left, size, 0.0, 0.0, cv::INTER_AREA);
  cv::resize(pair.right, right, size, 0.0, 0.0, cv::INTER_AREA);
  cv::resize(pair.left_mask, mask, size, 0.0, 0.0, cv::INTER_NEAREST);
  DenseOptions coarse = options;
  coarse.speckle_size_px = options.speckle_size_px / kCoarseness;
  cv::Mat disparity =
      MatchBlocks(left, right, RoundUpToSixteen(max_disparity_px / kCoarseness), coarse);
  disparity.setTo(0, mask == 0);
  std::vector<short> found(disparity.begin<short>(), disparity.end<short>());
  std::nth_element(found.begin(), found.begin() + kCoarseCount, found.end(), std::greater<>());
  const double nearest_px = static_cast<double>(found[kCoarseCount]) / kSteps * kCoarseness;
  return std::min(max_disparity_px, kRangeMargin * nearest_px + kCoarseness);
}

void DropMaskedMatches(const cv::Mat& right_mask, cv::Mat& disparity) {
  for (int row = 0; row < disparity.rows; ++row) {
    for (int column = 0; column < disparity.cols; ++column) {
      float& value = disparity.at<float>(row, column);
      const int right_column = cvRound(static_cast<float>(column) - value);
      if (value > 0.0F && (right_column < 0 || right_mask.at<uchar>(row, right_column) == 0))
        value = 0.0F;
    }
  }
}

}  // namespace

cv::Mat MatchDisparity(const RectifiedPair& pair, double max_disparity_px,
                       const DenseOptions& options) {
  cv::Mat disparity(pair.left.size(), CV_32FC1, cv::Scalar(0.0));
  const cv::Rect usable = cv::boundingRect(pair.left_mask);
  if (usable.empty()) return disparity;
  const bool blocks = options.method == DenseMethod::kBm;
  const int range =
      RoundUpToSixteen(blocks ? NarrowedRange(pair, max_disparity_px, options) : max_disparity_px);
  // Stereo matches lie to the left of the usable columns, by up to the range.
  const int first = std::max(0, usable.x - range);
  const cv::Rect searched(first, usable.y, usable.x + usable.width - first, usable.height);
  const cv::Mat left = pair.left(searched), right = pair.right(searched);
  const cv::Mat steps = blocks ? MatchBlocks(left, right, range, options)
                               : MatchCoarseToFine(left, right, max_disparity_px, options);
  steps.convertTo(disparity(searched), CV_32F, 1.0 / kSteps);
  disparity.setTo(0.0, (pair.left_mask == 0) | (disparity < 0.0));
  DropMaskedMatches(pair.right_mask, disparity);
  return disparity;
}

std::size_t MatchingBytes(cv::Size size, double max_disparity_px, const DenseOptions& options) {
  const std::size_t pixels = size.area(), result_bytes = 4 + 1;
  if (options.method == DenseMethod::kBm) return (result_bytes + 16) * pixels;
  return result_bytes * pixels + CoarseToFineBytes(size, max_disparity_px, options);
}

}  // namespace rigmap
