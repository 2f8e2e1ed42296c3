#include "gates/depth_consistency.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kMinTracks = 20;

// One term of a regression through the origin: y = slope x + noise. Terms of a track follow each
// other.
struct Term {
  double x = 1.0, y = 0.0, weight = 1.0;
  int track = 0;
};

double SlopeOf(const std::vector<Term>& terms) {
  double xy = 0.0, xx = 0.0;
  for (const Term& term : terms) {
    xy += term.weight * term.x * term.y;
    xx += term.weight * term.x * term.x;
  }
  return xy / xx;
}

// Weights terms down that lie beyond two robust sigmas (Huber).
void WeightRobustly(double slope, const std::vector<Term>& unweighted, std::vector<Term>& terms) {
  constexpr double kHuberSigmas = 2.0;
  std::vector<double> residuals;
  for (const Term& term : unweighted) {
    residuals.push_back(std::sqrt(term.weight) * std::abs(term.y - slope * term.x));
  }
  const double limit = kHuberSigmas * kSigmaOfMedianDeviation * Median(residuals);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    terms[i].weight = unweighted[i].weight * (residuals[i] > limit ? limit / residuals[i] : 1.0);
  }
}

// Of the slope, if only the scores of different tracks are independent (Liang and Zeger 1986).
double ClusteredSigma(double slope, const std::vector<Term>& terms) {
  double xx = 0.0, squares = 0.0, score = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Term& term = terms[i];
    score += term.weight * term.x * (term.y - slope * term.x);
    xx += term.weight * term.x * term.x;
    if (i + 1 < terms.size() && terms[i + 1].track == term.track) continue;
    squares += score * score;
    score = 0.0;
  }
  return std::sqrt(squares) / xx;
}

MeanDifference RobustSlope(const std::vector<Term>& unweighted) {
  constexpr int kIterations = 10;
  std::vector<Term> terms = unweighted;
  double slope = SlopeOf(terms);
  for (int i = 0; i < kIterations; ++i) {
    WeightRobustly(slope, unweighted, terms);
    slope = SlopeOf(terms);
  }
  return {slope, ClusteredSigma(slope, terms)};
}

int TrackCount(const std::vector<Term>& terms) {
  int count = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (i == 0 || terms[i].track != terms[i - 1].track) ++count;
  }
  return count;
}

// `terms` as for the mean of pixels, with the disparities as `x` for that of depths: a share of the
// depth is the same share of the disparity, the other way round.
std::optional<RegionDifference> DifferenceOf(const std::vector<Term>& terms) {
  const int tracks = TrackCount(terms);
  if (tracks < kMinTracks) return std::nullopt;
  const MeanDifference share = RobustSlope(terms);
  std::vector<Term> plain = terms;
  for (Term& term : plain) term.x = 1.0;
  return RegionDifference{tracks, RobustSlope(plain), {-100.0 * share.mean, 100.0 * share.sigma}};
}

// The variance is that of a sum of squares of normally distributed means.
SystematicDifference Systematic(const std::vector<std::optional<RegionDifference>>& regions,
                                MeanDifference RegionDifference::*difference) {
  double weights = 0.0, sum = 0.0, variance = 0.0;
  for (const auto& region : regions) {
    if (!region) continue;
    const double weight = region->tracks;
    const auto [mean, sigma] = (*region).*difference;
    weights += weight;
    sum += weight * (mean * mean - sigma * sigma);
    variance += weight * weight * sigma * sigma * (4.0 * mean * mean + 2.0 * sigma * sigma);
  }
  if (weights == 0.0) return {};
  const double square = std::max(0.0, sum / weights);
  const double value = std::sqrt(square);
  return {value, std::sqrt(square + std::sqrt(variance) / weights) - value};
}

template <class RegionOf>
DepthPartition Partition(const std::vector<DepthDifference>& differences, int count,
                         const RegionOf& region_of) {
  std::vector<std::vector<Term>> terms(static_cast<std::size_t>(count));
  for (const DepthDifference& difference : differences) {
    terms[std::clamp(region_of(difference.pixel), 0, count - 1)].push_back(
        {difference.disparity_px, difference.difference_px, 1.0 / difference.variance,
         difference.track});
  }
  DepthPartition partition;
  for (const auto& some : terms) partition.regions.push_back(DifferenceOf(some));
  partition.disparity_px = Systematic(partition.regions, &RegionDifference::disparity_px);
  partition.depth_pct = Systematic(partition.regions, &RegionDifference::depth_pct);
  return partition;
}

double FarthestCorner(const Camera& camera) {
  return std::hypot(std::max(camera.cx, camera.width - 1.0 - camera.cx),
                    std::max(camera.cy, camera.height - 1.0 - camera.cy));
}

}  // namespace

std::optional<DepthConsistency> DepthConsistencyOf(const Adjustment& adjustment) {
  const std::vector<DepthDifference> differences = CompareDepths(adjustment);
  if (differences.empty()) return std::nullopt;
  const Camera& camera = adjustment.rig.left.camera;
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  DepthConsistency result;
  result.ring_width_px = FarthestCorner(camera) / DepthConsistency::kRings;
  result.radius = Partition(differences, DepthConsistency::kRings, [&](const auto& at) {
    return static_cast<int>((at - centre).norm() / result.ring_width_px);
  });
  constexpr int kColumns = DepthConsistency::kColumns, kRows = DepthConsistency::kRows;
  const auto part_of = [](double at, int length, int parts) {
    return std::clamp(static_cast<int>((at + 0.5) / length * parts), 0, parts - 1);
  };
  result.cells = Partition(differences, kRows * kColumns, [&](const auto& at) {
    return part_of(at.y(), camera.height, kRows) * kColumns +
           part_of(at.x(), camera.width, kColumns);
  });
  const auto is_known = [](const auto& region) { return region.has_value(); };
  if (std::ranges::none_of(result.radius.regions, is_known)) return std::nullopt;
  return result;
}

}  // namespace rigmap
