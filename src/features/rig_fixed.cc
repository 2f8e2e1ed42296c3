#include "features/rig_fixed.h"

#include <algorithm>
#include <deque>
#include <optional>

#include "core/statistics.h"
#include "correspondence/feature_matching.h"

namespace rigmap {
namespace {

constexpr int kCellsAcross = 64;
// A rig-fixed feature rests to the noise of its detection, the ground moves by more.
constexpr double kRestingPx = 1.0, kMovingPx = 4.0;
// Further than this share of the width nothing is looked for: near ground may move out of reach,
// but the ground behind it does not.
constexpr double kReachShare = 0.06;
// So many matches move by chance or with a person while the rover stands.
constexpr std::size_t kMinMoving = 30;
constexpr double kMinMovingShare = 0.1;
constexpr int kMinVotes = 3;

// Of matches (features of the earlier frame).
struct Sorted {
  std::vector<int> resting, moving;
};

Sorted SortByMotion(const FrameFeatures& earlier, const FrameFeatures& later, double reach_px) {
  std::vector<std::optional<Eigen::Vector2d>> positions;
  for (const Feature& feature : earlier.features) positions.emplace_back(feature.left);
  Sorted sorted;
  for (const FeatureMatch& match : MatchFeatures(earlier, later, positions, reach_px, {})) {
    const double shift_px = (later.features[match.b].left - earlier.features[match.a].left).norm();
    if (shift_px <= kRestingPx) sorted.resting.push_back(match.a);
    if (shift_px >= kMovingPx) sorted.moving.push_back(match.a);
  }
  return sorted;
}

std::optional<double> Disparity(const Feature& feature) {
  return feature.right ? std::optional((feature.left - *feature.right).norm()) : std::nullopt;
}

}  // namespace

bool RigFixedCells::Cover(const Eigen::Vector2d& pixel) const {
  if (fixed.empty()) return false;
  const int cell =
      static_cast<int>(pixel.y()) / cell_px * columns + static_cast<int>(pixel.x()) / cell_px;
  return fixed[static_cast<std::size_t>(cell)] != 0;
}

cv::Mat RigFixedCells::Mask(int width, int height) const {
  cv::Mat mask(height, width, CV_8UC1, cv::Scalar(255));
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i] == 0) continue;
    const int index = static_cast<int>(i);
    const cv::Rect cell(index % columns * cell_px, index / columns * cell_px, cell_px, cell_px);
    mask(cell & cv::Rect(0, 0, width, height)).setTo(0);
  }
  return mask;
}

void RigFixedCells::RemoveFrom(FrameFeatures& features) const {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < features.features.size(); ++i) {
    if (!Cover(features.features[i].left)) kept.push_back(i);
  }
  if (kept.size() == features.features.size()) return;
  const auto keep = [&](auto& values) {
    if (values.empty()) return;  // not made for these
    for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
    values.resize(kept.size());
  };
  keep(features.features);
  keep(features.descriptors);
  keep(features.patches);
  keep(features.tracks);
}

RigFixedVotes::RigFixedVotes(int width, int height) : width_px_(width) {
  grid_.cell_px = std::max(1, (width + kCellsAcross - 1) / kCellsAcross);
  grid_.columns = width / grid_.cell_px + 1;
  const int rows = height / grid_.cell_px + 1;
  for_.assign(static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(rows), 0);
  against_ = for_;
}

int RigFixedVotes::CellOf(const Eigen::Vector2d& pixel) const {
  return static_cast<int>(pixel.y()) / grid_.cell_px * grid_.columns +
         static_cast<int>(pixel.x()) / grid_.cell_px;
}

void RigFixedVotes::Compare(const FrameFeatures& earlier, const FrameFeatures& later) {
  const Sorted sorted = SortByMotion(earlier, later, kReachShare * width_px_);
  if (sorted.moving.size() < kMinMoving ||
      static_cast<double>(sorted.moving.size()) <
          kMinMovingShare * static_cast<double>(sorted.resting.size())) {
    return;
  }
  std::vector<double> disparities;
  for (const int i : sorted.moving) {
    ++against_[CellOf(earlier.features[i].left)];
    if (const auto disparity = Disparity(earlier.features[i])) disparities.push_back(*disparity);
  }
  if (disparities.empty()) return;
  const double near_px = Median(std::move(disparities));
  for (const int i : sorted.resting) {
    const auto disparity = Disparity(earlier.features[i]);
    if (disparity && *disparity >= near_px) ++for_[CellOf(earlier.features[i].left)];
  }
}

RigFixedCells RigFixedVotes::Decide() const {
  RigFixedCells cells = grid_;
  cells.fixed.assign(for_.size(), 0);
  for (std::size_t i = 0; i < for_.size(); ++i) {
    cells.fixed[i] = for_[i] >= kMinVotes && for_[i] >= against_[i] ? 1 : 0;
  }
  return cells;
}

RigFixedCells FindRigFixed(int frame_count, const FeatureSource& features, const Camera& left) {
  constexpr std::size_t kFurthest = 3;
  RigFixedVotes votes(left.width, left.height);
  std::deque<FrameFeatures> last;
  for (int frame = 0; frame < frame_count; ++frame) {
    FrameFeatures current = features(frame);
    if (!last.empty()) votes.Compare(last.back(), current);
    if (last.size() == kFurthest) {
      votes.Compare(last.front(), current);
      last.pop_front();
    }
    last.push_back(std::move(current));
  }
  return votes.Decide();
}

}  // namespace rigmap
