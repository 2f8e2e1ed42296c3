#include "tests/dense/semi_global_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "dense/internal/matching_cost.h"
#include "dense/internal/view_rows.h"
#include "dense/internal/winner.h"

namespace rigmap {
namespace {

// The edges are repeated.
int At(const cv::Mat& view, int column, int row) {
  return view.at<uchar>(std::clamp(row, 0, view.rows - 1), std::clamp(column, 0, view.cols - 1));
}

cv::Mat GradientOf(const cv::Mat& view) {
  cv::Mat gradient(view.size(), CV_8U);
  for (int row = 0; row < view.rows; ++row) {
    for (int column = 0; column < view.cols; ++column) {
      int slope = 0;
      for (const auto& [dy, weight] : {std::pair(-1, 1), {0, 2}, {1, 1}}) {
        slope += weight * (At(view, column + 1, row + dy) - At(view, column - 1, row + dy));
      }
      gradient.at<uchar>(row, column) =
          static_cast<uchar>(std::clamp(slope, -kGradientLimit, kGradientLimit) + kGradientLimit);
    }
  }
  return gradient;
}

// How far a value lies from what a view shows within half a pixel.
int Beyond(int value, const cv::Mat& view, int column, int row) {
  const int here = At(view, column, row);
  const auto [least, most] = std::minmax(
      {here, (here + At(view, column - 1, row)) / 2, (here + At(view, column + 1, row)) / 2});
  return std::max({0, value - most, least - value});
}

// Birchfield and Tomasi's.
int Dissimilarity(const cv::Mat& left, const cv::Mat& right, int column, int row, int other) {
  return std::min(Beyond(At(left, column, row), right, other, row),
                  Beyond(At(right, other, row), left, column, row));
}

class Reference {
 public:
  Reference(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
            const DenseOptions& options)
      : left_(left),
        right_(right),
        left_gradient_(GradientOf(left)),
        right_gradient_(GradientOf(right)),
        windows_(windows),
        options_(options),
        scale_(options) {}

  cv::Mat Match() {
    FindCosts();
    std::vector<std::vector<int>> sums = costs_;
    for (auto& pixel : sums) {
      for (int& sum : pixel) sum *= 8;
    }
    for (const auto& [dx, dy] :
         {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}) {
      AddPath(dx, dy, sums);
    }
    cv::Mat disparities(left_.size(), CV_16S);
    for (int row = 0; row < left_.rows; ++row) ChooseInRow(row, sums, disparities);
    return disparities;
  }

 private:
  const DisparityWindow& WindowAt(int column, int row) const {
    return windows_.At(column / TileWindows::kTilePx, row / TileWindows::kTilePx);
  }
  bool Contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < left_.cols && row < left_.rows;
  }
  std::size_t IndexOf(int column, int row) const {
    return static_cast<std::size_t>(row) * left_.cols + column;
  }

  int PixelCost(int column, int row, int disparity) const {
    column = std::clamp(column, 0, left_.cols - 1);
    row = std::clamp(row, 0, left_.rows - 1);
    const int other = std::max(column - disparity, 0);
    return Dissimilarity(left_gradient_, right_gradient_, column, row, other) +
           (Dissimilarity(left_, right_, column, row, other) >> MatchingCost::kGreyShift);
  }

  void FindCosts() {
    const int radius = options_.block_px / 2;
    for (int row = 0; row < left_.rows; ++row) {
      for (int column = 0; column < left_.cols; ++column) {
        const DisparityWindow& window = WindowAt(column, row);
        auto& pixel = costs_.emplace_back();
        for (int d = window.first; d < window.End(); ++d) {
          int sum = 0;
          for (int y = row - radius; y <= row + radius; ++y) {
            for (int x = column - radius; x <= column + radius; ++x) sum += PixelCost(x, y, d);
          }
          const std::int64_t scaled =
              std::int64_t{std::min(4 * sum, 65535)} * scale_.multiplier / 65536;
          pixel.push_back(static_cast<int>(std::min<std::int64_t>(scaled, CostScale::kMostCost)));
        }
      }
    }
  }

  // m(p, d) of a pixel with the aggregated costs of the one before on the path.
  int Step(const std::vector<int>& before, int ahead) const {
    const auto at = [&](int index) {
      return index < 0 || index >= static_cast<int>(before.size()) ? 255 : before[index];
    };
    const int least = *std::min_element(before.begin(), before.end());
    return std::min({at(ahead), at(ahead - 1) + scale_.small_step,
                     at(ahead + 1) + scale_.small_step,
                     std::min(255, least + CostScale::kLargeStep)}) -
           least;
  }

  void AddPath(int dx, int dy, std::vector<std::vector<int>>& sums) const {
    std::vector<std::vector<int>> aggregated = costs_;
    for (int j = 0; j < left_.rows; ++j) {
      for (int i = 0; i < left_.cols; ++i) {
        const int row = dy < 0 ? left_.rows - 1 - j : j;
        const int column = dx < 0 ? left_.cols - 1 - i : i;
        if (!Contains(column - dx, row - dy)) continue;
        const int shift = WindowAt(column, row).first - WindowAt(column - dx, row - dy).first;
        auto& here = aggregated[IndexOf(column, row)];
        for (int k = 0; k < static_cast<int>(here.size()); ++k) {
          const int step = Step(aggregated[IndexOf(column - dx, row - dy)], k + shift);
          here[k] += step;
          sums[IndexOf(column, row)][k] += step;
        }
      }
    }
  }

  bool IsUnique(const std::vector<int>& sums, int best) const {
    for (int k = 0; k < static_cast<int>(sums.size()); ++k) {
      const bool near_best = std::abs(k - best) <= 1;
      if (!near_best && sums[k] * (100 - options_.uniqueness_pct) < 100 * sums[best]) return false;
    }
    return true;
  }

  // By column of the right view: the disparity with the least sum; the first of equal ones, by
  // column of the left view.
  std::vector<int> SeenFromRight(int row, const std::vector<std::vector<int>>& sums) const {
    std::vector<int> least(left_.cols, 65535), disparity(left_.cols, 0);
    for (int column = 0; column < left_.cols; ++column) {
      const DisparityWindow& window = WindowAt(column, row);
      for (int d = window.first; d < window.End() && d <= column; ++d) {
        const int sum = sums[IndexOf(column, row)][d - window.first];
        if (sum >= least[column - d]) continue;
        least[column - d] = sum;
        disparity[column - d] = d;
      }
    }
    return disparity;
  }

  void ChooseInRow(int row, const std::vector<std::vector<int>>& sums, cv::Mat& disparities) const {
    constexpr int kSteps = WinnerRow::kSteps;
    const std::vector<int> right_disparity = SeenFromRight(row, sums);
    for (int column = 0; column < left_.cols; ++column) {
      const auto& s = sums[IndexOf(column, row)];
      const int best = static_cast<int>(std::min_element(s.begin(), s.end()) - s.begin());
      const int d = WindowAt(column, row).first + best;
      auto& disparity = disparities.at<short>(row, column);
      disparity = WinnerRow::kNoDisparity;
      const bool inside = best > 0 && best + 1 < static_cast<int>(s.size()) && d <= column &&
                          d <= WinnerRow::kMostDisparity;
      if (!inside || !IsUnique(s, best)) continue;
      const double bend = std::max(s[best - 1] + s[best + 1] - 2 * s[best], 1);
      disparity = static_cast<short>(
          d * kSteps + std::lround(kSteps * (s[best - 1] - s[best + 1]) / (2.0 * bend)));
    }
    for (int column = 0; column < left_.cols; ++column) {
      auto& disparity = disparities.at<short>(row, column);
      if (disparity == WinnerRow::kNoDisparity) continue;
      bool agrees = false;
      for (const int d : {disparity / kSteps, (disparity + kSteps - 1) / kSteps}) {
        const int other = column - d;
        agrees |= other >= 0 && std::abs(right_disparity[other] - d) <= options_.left_right_px;
      }
      if (!agrees) disparity = WinnerRow::kNoDisparity;
    }
  }

  const cv::Mat left_, right_, left_gradient_, right_gradient_;
  const TileWindows& windows_;
  const DenseOptions& options_;
  CostScale scale_;
  std::vector<std::vector<int>> costs_;  // of each pixel over its window
};

}  // namespace

cv::Mat MatchByReference(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                         const DenseOptions& options) {
  return Reference(left, right, windows, options).Match();
}

}  // namespace rigmap
