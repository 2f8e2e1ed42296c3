#include "fusion/internal/carried_cells.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/statistics.h"
#include "fusion/internal/frame_comparison.h"
#include "fusion/internal/view_consistency.h"

namespace rigmap {
namespace {

constexpr std::size_t kFramesAsked = 40;  // frames, evenly over the part
constexpr int kFewestAsked = 6;           // that could be asked
// Of the frames asked. Who drives ahead for a while is at some cells, too.
constexpr int kMinVotes = 3;
constexpr double kMinShare = 0.1;
constexpr int kForOverAgainst = 2;
// Of the depth of what is nearest: so far back a frame sees past it.
constexpr double kStepBack = 0.5;
constexpr double kNearest = 0.02;   // share of the pixels that are nearer
constexpr std::size_t kReach = 30;  // frames

double NearestDepth(const DepthMap& map) {
  std::vector<double> disparities;
  for (int row = 0; row < map.disparity.rows; row += kOpinionStride) {
    for (int column = 0; column < map.disparity.cols; column += kOpinionStride) {
      const float disparity_px = map.disparity.at<float>(row, column);
      if (disparity_px > 0.0F) disparities.push_back(disparity_px);
    }
  }
  if (disparities.empty()) return 0.0;
  return map.Depth(Quantile(std::move(disparities), 1.0 - kNearest));
}

// The last frame before it that lies far enough back and looks the same way.
std::optional<std::size_t> FurtherBack(std::size_t frame, double step_m,
                                       std::span<const Rigid3> world_from_left,
                                       const FusionOptions& options) {
  const Rigid3& own = world_from_left[frame];
  const Eigen::Vector3d forward = own.rotation * Eigen::Vector3d::UnitZ();
  for (std::size_t back = 1; back <= std::min(frame, kReach); ++back) {
    const Rigid3& other = world_from_left[frame - back];
    const double ahead_m = forward.dot(own.translation - other.translation);
    if (ahead_m < step_m) continue;
    if (!FaceAlike(own, other, options)) return std::nullopt;
    return frame - back;
  }
  return std::nullopt;
}

// CV_32SC1 by cell: how many frames further back see through, and how many agree.
struct Votes {
  cv::Mat through, agreeing;
  int asked = 0;

  void Add(const cv::Mat& opinions) {
    if (through.empty()) {
      through = cv::Mat::zeros(opinions.size(), CV_32SC1);
      agreeing = through.clone();
    }
    cv::add(through, 1, through, opinions == kSeenClearlyThrough);
    cv::add(agreeing, 1, agreeing, opinions == kSeenAsHere);
    ++asked;
  }
};

}  // namespace

cv::Mat CarriedByTheRig(std::span<const Rigid3> world_from_left, const FusionOptions& options,
                        ViewCache& views) {
  const std::size_t count = world_from_left.size(), asked = std::min(kFramesAsked, count);
  Votes votes;
  cv::Size size;
  for (std::size_t i = 0; i < asked; ++i) {
    const std::size_t frame = i * count / asked;
    const double nearest_m = NearestDepth(views.Get({&frame, 1}).front()->map);
    const auto back = FurtherBack(frame, kStepBack * nearest_m, world_from_left, options);
    if (!(nearest_m > 0.0) || !back) continue;
    const std::size_t frames[] = {frame, *back};
    const auto pair = views.Get(frames);
    size = pair[0]->map.disparity.size();
    votes.Add(OpinionsOn(*pair[0], *pair[1], options));
  }
  if (votes.asked < kFewestAsked) return {};
  const int least = std::max(kMinVotes, static_cast<int>(std::ceil(kMinShare * votes.asked)));
  cv::Mat carried = (votes.through >= least) & (votes.through >= kForOverAgainst * votes.agreeing);
  if (cv::countNonZero(carried) == 0) return {};
  // As far as the next pixel that was asked about, where something else is seen.
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < carried.rows; ++row) {
    for (int column = 0; column < carried.cols; ++column) {
      if (carried.at<std::uint8_t>(row, column) == 0) continue;
      mask.at<std::uint8_t>(row * kOpinionStride, column * kOpinionStride) = 255;
    }
  }
  constexpr int kSide = 2 * kOpinionStride + 1;
  cv::dilate(mask, mask, cv::Mat::ones(kSide, kSide, CV_8UC1));
  return mask;
}

}  // namespace rigmap
