// How badly a left pixel and a right one fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

#include "dense/dense_options.h"
#include "dense/internal/disparity_windows.h"

namespace rigmap {

// Costs are scaled so that a large step costs kLargeStep: four paths' steps then fit into a byte,
// and so does a cost with a step.
struct CostScale {
  static constexpr int kLargeStep = 63;
  static constexpr int kMostCost = 255 - kLargeStep;  // larger ones count as this
  static constexpr int kLargestBlock = 17;            // px; sums over larger ones overflow 16 bit

  int multiplier = 0;  // cost = min(kMostCost, min(4 sum, 65535) * multiplier / 65536)
  int small_step = 0;

  explicit CostScale(const DenseOptions& options);
};

// The cost of a pair of pixels is that of Birchfield and Tomasi 1998 (a difference that half a
// pixel to either side may lessen) of horizontal gradients, clipped (view_rows.h), and a quarter of
// that of grey values; summed over block_px x block_px pixels, edges repeated. As in OpenCV's
// StereoSGBM.
//
// Holds views CV_8UC1 of equal size; thread-safe.
class MatchingCost {
 public:
  static constexpr int kGreyShift = 2;

  // `windows` must outlive it.
  MatchingCost(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
               const DenseOptions& options);

  // Costs of all pixels of a row of tiles, pixel row by pixel row as RowLayout says. Matches beyond
  // the right view's edge cost kMostCost.
  void OfTileRow(int tile_row, const RowLayout& layout, std::uint8_t* costs) const;

  // What OfTileRow takes besides.
  static std::size_t WorkBytes(const TileWindows& windows, const DenseOptions& options);

 private:
  cv::Mat left_, right_;
  const TileWindows& windows_;
  int radius_ = 0;
  std::size_t work_bytes_ = 0;
  CostScale scale_;
};

}  // namespace rigmap
