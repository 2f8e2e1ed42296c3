// The part of BundleSolver that lists what meets what.
#include <tbb/parallel_for.h>

#include <algorithm>

#include "adjustment/internal/bundle_solver.h"
#include "adjustment/internal/datum_frames.h"

namespace rigmap {
namespace {

constexpr std::size_t kPartPoints = 256;

template <class Value>
int IndexIn(const std::vector<Value>& ascending, const Value& value) {
  return static_cast<int>(std::lower_bound(ascending.begin(), ascending.end(), value) -
                          ascending.begin());
}

template <class Value>
void SortUnique(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

BundleSolver::BundleSolver(Bundle& bundle, double huber_px) : bundle_(bundle), huber_px_(huber_px) {
  for (const auto& pose : bundle.left_from_world) poses_.push_back(pose.value_or(Rigid3()));
  for (const AdjustedPoint& point : bundle.points) points_.push_back(point.x);
  NumberUnknowns();
  ListViews();
  ListPairs();
}

void BundleSolver::NumberUnknowns() {
  const std::vector<int> datum_frames = DatumFrames(bundle_.points, poses_.size());
  const std::vector<int> counts = ObservationsPerFrame(bundle_);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const bool is_held = counts[i] == 0 || datum_frames[i] == static_cast<int>(i);
    unknown_.push_back(is_held ? -1 : unknowns_++);
  }
}

void BundleSolver::ListViews() {
  const auto for_views = [&](const AdjustedPoint& point, const auto& visit) {
    int last_frame = -1;
    for (const PointObservation& o : point.observations) {
      if (o.frame != last_frame && unknown_[o.frame] >= 0) visit(unknown_[o.frame]);
      last_frame = o.frame;
    }
  };
  std::size_t count = 0;
  for (const AdjustedPoint& point : bundle_.points) for_views(point, [&](int) { ++count; });
  views_.reserve(count);  // the largest that there is: no room for more
  for (const AdjustedPoint& point : bundle_.points) {
    first_view_.push_back(views_.size());
    for_views(point, [&](int unknown) { views_.push_back({unknown, 0, PosePoint::Zero()}); });
  }
  first_view_.push_back(views_.size());
  eliminated_.resize(points_.size());
  for (std::size_t begin = 0; begin < points_.size(); begin += kPartPoints) {
    parts_.push_back({.begin = begin, .end = std::min(begin + kPartPoints, points_.size())});
  }
}

void BundleSolver::ListPairs() {
  std::vector<std::vector<PoseMatrix::Pair>> pairs_of_part(parts_.size());
  const auto for_views = [&](const Part& part, const auto& visit) {
    for (std::size_t point = part.begin; point < part.end; ++point) {
      for (std::size_t a = first_view_[point]; a < first_view_[point + 1]; ++a) {
        for (std::size_t b = first_view_[point]; b <= a; ++b) {
          visit(PoseMatrix::Pair(views_[b].unknown, views_[a].unknown));
        }
      }
    }
  };
  tbb::parallel_for(std::size_t{0}, parts_.size(), [&](std::size_t i) {
    Part& part = parts_[i];
    for_views(part, [&](const PoseMatrix::Pair& pair) { pairs_of_part[i].push_back(pair); });
    part.pair_of.reserve(pairs_of_part[i].size());
    SortUnique(pairs_of_part[i]);
    for_views(part, [&](const PoseMatrix::Pair& pair) {
      part.pair_of.push_back(IndexIn(pairs_of_part[i], pair));
    });
    for (const auto& [column, row] : pairs_of_part[i]) {
      if (column == row) part.unknowns.push_back(row);
    }
    for (std::size_t v = first_view_[part.begin]; v < first_view_[part.end]; ++v) {
      views_[v].local = IndexIn(part.unknowns, views_[v].unknown);
    }
  });
  for (const auto& pairs : pairs_of_part) {
    pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
  }
  SortUnique(pairs_);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (const auto& pair : pairs_of_part[i]) parts_[i].pairs.push_back(IndexIn(pairs_, pair));
  }
  if (unknowns_ > 0) matrix_.emplace(unknowns_, pairs_);
}

}  // namespace rigmap
