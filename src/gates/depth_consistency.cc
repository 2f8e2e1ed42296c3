#include "gates/depth_consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kMinTracks = 20;
// Tracks that are seen together share errors of the poses; stretches of the drive do not.
constexpr int kStretches = 8;

// One term of a regression through the origin: y = slope x + noise.
struct Term {
  double x = 1.0, y = 0.0, weight = 1.0;
  int track = 0, stretch = 0;
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

// Of the slope, if the scores of different clusters are independent (Liang and Zeger 1986).
double ClusteredSigma(double slope, const std::vector<Term>& terms, int Term::*cluster) {
  std::map<int, double> scores;
  double xx = 0.0, squares = 0.0;
  for (const Term& term : terms) {
    scores[term.*cluster] += term.weight * term.x * (term.y - slope * term.x);
    xx += term.weight * term.x * term.x;
  }
  if (scores.size() < 2) return 0.0;
  for (const auto& [name, score] : scores) squares += score * score;
  const auto count = static_cast<double>(scores.size());
  return std::sqrt(squares * count / (count - 1.0)) / xx;
}

MeanDifference RobustSlope(const std::vector<Term>& unweighted) {
  constexpr int kIterations = 10;
  std::vector<Term> terms = unweighted;
  double slope = SlopeOf(terms);
  for (int i = 0; i < kIterations; ++i) {
    WeightRobustly(slope, unweighted, terms);
    slope = SlopeOf(terms);
  }
  return {slope, std::max(ClusteredSigma(slope, terms, &Term::track),
                          ClusteredSigma(slope, terms, &Term::stretch))};
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
DepthPartition Partition(const std::vector<DepthDifference>& differences,
                         const std::vector<int>& stretches, std::size_t count,
                         const RegionOf& region_of) {
  std::vector<std::vector<Term>> terms(count);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const DepthDifference& difference = differences[i];
    const int region = std::clamp(region_of(difference.pixel), 0, static_cast<int>(count) - 1);
    terms[static_cast<std::size_t>(region)].push_back(
        {difference.disparity_px, difference.difference_px, 1.0 / difference.variance,
         difference.track, stretches[i]});
  }
  DepthPartition partition;
  for (const auto& some : terms) partition.regions.push_back(DifferenceOf(some));
  partition.disparity_px = Systematic(partition.regions, &RegionDifference::disparity_px);
  partition.depth_pct = Systematic(partition.regions, &RegionDifference::depth_pct);
  return partition;
}

// Of each difference, the stretch in which its track begins: eight with as many tracks each.
std::vector<int> StretchesOf(const std::vector<DepthDifference>& differences) {
  std::vector<int> first_frames;  // of each difference's track
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const bool is_same = i > 0 && differences[i].track == differences[i - 1].track;
    first_frames.push_back(is_same ? first_frames.back() : differences[i].frame);
  }
  std::array<int, kStretches - 1> ends{};
  for (int i = 1; i < kStretches; ++i) {
    ends[i - 1] = Quantile(first_frames, static_cast<double>(i) / kStretches);
  }
  std::vector<int> stretches;
  for (const int frame : first_frames) {
    stretches.push_back(
        static_cast<int>(std::upper_bound(ends.begin(), ends.end(), frame) - ends.begin()));
  }
  return stretches;
}

double FarthestCorner(const Camera& camera) {
  return std::hypot(std::max(camera.cx, camera.width - 1.0 - camera.cx),
                    std::max(camera.cy, camera.height - 1.0 - camera.cy));
}

}  // namespace

std::optional<DepthConsistency> DepthConsistencyOf(const Adjustment& adjustment) {
  const std::vector<DepthDifference> differences = CompareDepths(adjustment);
  if (differences.empty()) return std::nullopt;
  const std::vector<int> stretches = StretchesOf(differences);
  const Camera& camera = adjustment.rig.left.camera;
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  DepthConsistency result;
  result.ring_width_px = FarthestCorner(camera) / DepthConsistency::kRings;
  result.radius = Partition(differences, stretches, DepthConsistency::kRings, [&](const auto& at) {
    return static_cast<int>((at - centre).norm() / result.ring_width_px);
  });
  const auto part = [](double at, int length, int parts) {
    return std::clamp(static_cast<int>((at + 0.5) / length * parts), 0, parts - 1);
  };
  result.cells = Partition(
      differences, stretches, DepthConsistency::kColumns * DepthConsistency::kRows,
      [&](const auto& at) {
        return part(at.y(), camera.height, DepthConsistency::kRows) * DepthConsistency::kColumns +
               part(at.x(), camera.width, DepthConsistency::kColumns);
      });
  const auto is_known = [](const auto& region) { return region.has_value(); };
  if (std::ranges::none_of(result.radius.regions, is_known)) return std::nullopt;
  return result;
}

}  // namespace rigmap
