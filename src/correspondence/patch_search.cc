#include "correspondence/patch_search.h"

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

constexpr int kHalfWindow = kPatchRadius - kPatchReach;
constexpr int kWindow = 2 * kHalfWindow + 1;

cv::Mat ViewOf(const Patch& patch) {
  // Read only.
  return {kPatchSize, kPatchSize, CV_8UC1, const_cast<std::uint8_t*>(patch.data())};
}

// What the middle of the searched patch would show if the point were there.
cv::Mat ExpectedWindow(const SearchedPatch& searched) {
  const Eigen::Matrix2d patch_from_searched = searched.searched_from_patch.inverse();
  cv::Mat columns(kWindow, kWindow, CV_32F), rows(kWindow, kWindow, CV_32F), window;
  for (int y = 0; y < kWindow; ++y) {
    for (int x = 0; x < kWindow; ++x) {
      const Eigen::Vector2d at =
          searched.offset + patch_from_searched * Eigen::Vector2d(x - kHalfWindow, y - kHalfWindow);
      columns.at<float>(y, x) = static_cast<float>(kPatchRadius + at.x());
      rows.at<float>(y, x) = static_cast<float>(kPatchRadius + at.y());
    }
  }
  cv::remap(ViewOf(searched.patch), window, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return window;
}

// Of the parabola through a peak and its neighbours, from the peak.
double PeakOffset(double before, double peak, double after) {
  const double bend = before - 2.0 * peak + after;
  return bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
}

}  // namespace

std::optional<Eigen::Vector2d> FindInPatch(const SearchedPatch& searched, const Patch& in) {
  constexpr double kLeastCorrelation = 0.5, kLeastLead = 0.05;
  constexpr int kSamePeak_px = 2;
  cv::Mat scores;
  cv::matchTemplate(ViewOf(in), ExpectedWindow(searched), scores, cv::TM_CCOEFF_NORMED);
  double best = 0.0, second = 0.0;
  cv::Point at;
  cv::minMaxLoc(scores, nullptr, &best, nullptr, &at);
  // A peak at the edge may be the slope of one outside.
  const cv::Rect inner(1, 1, scores.cols - 2, scores.rows - 2);
  if (!(best >= kLeastCorrelation) || !inner.contains(at)) return std::nullopt;
  const auto score = [&](int dx, int dy) {
    return static_cast<double>(scores.at<float>(at.y + dy, at.x + dx));
  };
  const Eigen::Vector2d peak(at.x + PeakOffset(score(-1, 0), best, score(1, 0)),
                             at.y + PeakOffset(score(0, -1), best, score(0, 1)));
  cv::circle(scores, at, kSamePeak_px, cv::Scalar(-1.0), cv::FILLED);
  cv::minMaxLoc(scores, nullptr, &second);
  if (best - second < kLeastLead) return std::nullopt;
  return peak - Eigen::Vector2d::Constant(kPatchReach);
}

}  // namespace rigmap
