#include "imaging/mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/error.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

// The sky is looked for at this reduction: noise averages out, textured ground does not.
constexpr int kSkyReduction = 4;
// Largest grey step between neighbours in the reduced image that still counts as smooth.
constexpr int kSmoothStep = 6;
// Sky is brighter than the median below it by at least this many grey levels.
constexpr int kSkyContrast = 20;
// Of a mask file with 16 bit a value every value but 0 stays one.
constexpr int kMaskBits = 8;

cv::Mat Square(int size) { return cv::getStructuringElement(cv::MORPH_RECT, {size, size}); }

cv::Mat SaturatedAreas(const cv::Mat& grey, const MaskOptions& options) {
  cv::Mat saturated = grey >= options.saturation_level;
  cv::erode(saturated, saturated, Square(options.saturation_width_px));
  const int margin_px = static_cast<int>(std::ceil(options.saturation_margin_px));
  cv::dilate(saturated, saturated, Square(options.saturation_width_px + 2 * margin_px));
  return saturated;
}

int MedianOf(const cv::Mat& grey, const cv::Mat& where) {
  std::array<int, 256> histogram{};
  int count = 0;
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      if (where.at<uchar>(row, column) == 0) continue;
      ++histogram[grey.at<uchar>(row, column)];
      ++count;
    }
  }
  int median = 0;
  for (int below = histogram[0]; 2 * below < count; below += histogram[++median]) {
  }
  return median;
}

cv::Mat Smooth(const cv::Mat& small) {
  cv::Mat highest, lowest;
  cv::dilate(small, highest, Square(3));
  cv::erode(small, lowest, Square(3));
  return highest - lowest <= kSmoothStep;
}

// The parts of `candidates` that are connected with the top row and are for the most part `bright`.
cv::Mat HangingFromTop(const cv::Mat& candidates, const cv::Mat& bright) {
  cv::Mat labels;
  const int count = cv::connectedComponents(candidates, labels, 4, CV_32S);
  std::vector<int> brightness(static_cast<std::size_t>(count), 0);  // bright less other pixels
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      brightness[labels.at<int>(row, column)] += bright.at<uchar>(row, column) != 0 ? 1 : -1;
    }
  }
  std::vector<bool> is_sky(static_cast<std::size_t>(count), false);
  for (int column = 0; column < labels.cols; ++column) {
    const int label = labels.at<int>(0, column);
    is_sky[label] = label != 0 && brightness[label] > 0;
  }
  cv::Mat hanging(candidates.size(), CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      if (is_sky[labels.at<int>(row, column)]) hanging.at<uchar>(row, column) = 255;
    }
  }
  return hanging;
}

// The sky in the reduced image: smooth, hanging from the top, above `lowest`, brighter than
// `least`.
cv::Mat SkyAbove(const cv::Mat& small, int lowest, int least, int bright) {
  cv::Mat candidates = Smooth(small) & (small > least);
  candidates.rowRange(lowest, small.rows).setTo(0);
  // Cuts thin bridges, through which the region would leak into smooth ground.
  cv::morphologyEx(candidates, candidates, cv::MORPH_OPEN, Square(3));
  return HangingFromTop(candidates, small > bright);
}

cv::Mat Sky(const cv::Mat& grey, const MaskOptions& options) {
  if (std::min(grey.rows, grey.cols) < 8 * kSkyReduction)
    return cv::Mat::zeros(grey.size(), CV_8UC1);
  cv::Mat small;
  cv::resize(grey, small, {}, 1.0 / kSkyReduction, 1.0 / kSkyReduction, cv::INTER_AREA);
  const int lowest = std::max(1, static_cast<int>(options.sky_lowest_share * small.rows));
  cv::Mat below(small.size(), CV_8UC1, cv::Scalar(255));
  below.rowRange(0, lowest).setTo(0);
  const int ground = MedianOf(small, below);
  const int bright = ground + kSkyContrast;
  // Clouds may be hardly brighter than the ground. A region grown that far which meets the lowest
  // row has leaked into the ground through a hazy horizon; then only what is bright counts.
  cv::Mat sky = SkyAbove(small, lowest, ground, bright);
  if (cv::countNonZero(sky.row(lowest - 1)) > 0) sky = SkyAbove(small, lowest, bright, bright);
  cv::dilate(sky, sky, Square(5));  // the rim that the smoothness test took away
  cv::Mat full;
  cv::resize(sky, full, grey.size(), 0.0, 0.0, cv::INTER_NEAREST);
  return full;
}

}  // namespace

cv::Mat StaticMask(const RigEye& eye) {
  const cv::Rect whole(0, 0, eye.camera.width, eye.camera.height);
  cv::Mat mask(whole.size(), CV_8UC1, cv::Scalar(0));
  cv::Rect region = whole;
  if (eye.calibrated_region) {
    const PixelRegion& r = *eye.calibrated_region;
    region &= cv::Rect(cv::Point(r.x0, r.y0), cv::Point(r.x1 + 1, r.y1 + 1));
  }
  mask(region).setTo(255);
  if (eye.mask_path.empty()) return mask;
  mask.setTo(0, ReadGrey(eye.mask_path, eye.camera, kMaskBits) == 0);
  if (cv::countNonZero(mask) == 0) {
    throw DataError(fmt::format(
        "{}: expected a mask that is zero where nothing is to be used, found nothing else{}",
        eye.mask_path, eye.calibrated_region ? " in the calibrated region" : ""));
  }
  return mask;
}

cv::Mat BlackAreas(const cv::Mat& grey, const MaskOptions& options, int width_px) {
  cv::Mat black = grey < options.black_level;
  cv::morphologyEx(black, black, cv::MORPH_OPEN, Square(width_px));
  return black;
}

cv::Mat UsableMask(const cv::Mat& grey, const cv::Mat& static_mask, const MaskOptions& options) {
  cv::Mat usable = static_mask.clone();
  usable.setTo(0, SaturatedAreas(grey, options));
  usable.setTo(0, BlackAreas(grey, options, options.saturation_width_px));
  if (options.sky) usable.setTo(0, Sky(grey, options));
  return usable;
}

}  // namespace rigmap
