#include "fusion/internal/covering_views.h"

#include <algorithm>

namespace rigmap {
namespace {

// Places of a depth map that no view shows so far.
class Unconfirmed {
 public:
  explicit Unconfirmed(const DepthView& own) : own_(own) {
    constexpr int kStride = 16;
    const cv::Mat& disparity = own.map.disparity;
    for (int row = kStride / 2; row < disparity.rows; row += kStride) {
      for (int column = kStride / 2; column < disparity.cols; column += kStride) {
        const double found_px = disparity.at<float>(row, column);
        if (found_px <= 0.0) continue;
        in_world_.push_back(own.world_from_rectified *
                            own.map.PointInRectified(column, row, found_px));
      }
    }
    least_ = std::max(1.0, kLeastPart * static_cast<double>(in_world_.size()));
  }

  bool AreFew() const { return static_cast<double>(in_world_.size()) < least_; }

  // Whether the view shows a part of them, which are none then. With `always` they are none
  // however few.
  bool TakeShown(const Rigid3& world_from_left, bool always) {
    const Rigid3 rectified_from_world = (world_from_left * own_.map.left_from_rectified).Inverse();
    const auto shown = std::partition(in_world_.begin(), in_world_.end(), [&](const auto& x) {
      return !own_.map.PixelOf(rectified_from_world * x);
    });
    if (!always && static_cast<double>(in_world_.end() - shown) < least_) return false;
    in_world_.erase(shown, in_world_.end());
    return true;
  }

 private:
  const DepthView& own_;
  std::vector<Eigen::Vector3d> in_world_;
  double least_ = 0.0;
};

}  // namespace

std::vector<std::size_t> CoveringViews(const DepthView& own,
                                       std::span<const std::size_t> candidates,
                                       std::span<const Rigid3> world_from_left, std::size_t count) {
  const std::size_t taken_at_most = std::min(count, candidates.size());
  const std::size_t nearest = std::min((count + 1) / 2, taken_at_most);
  Unconfirmed unconfirmed(own);
  std::vector<char> is_taken(candidates.size(), 0);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < candidates.size() && taken < taken_at_most; ++i) {
    if (i >= nearest && unconfirmed.AreFew()) break;
    is_taken[i] = unconfirmed.TakeShown(world_from_left[candidates[i]], i < nearest);
    taken += is_taken[i];
  }
  std::vector<std::size_t> views;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!is_taken[i] && taken < taken_at_most) {
      is_taken[i] = 1;
      ++taken;
    }
    if (is_taken[i]) views.push_back(candidates[i]);
  }
  return views;
}

}  // namespace rigmap
