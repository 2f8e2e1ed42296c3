#include "correspondence/stereo_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/statistics.h"
#include "correspondence/internal/pose_problem.h"
#include "correspondence/internal/three_point_poses.h"

namespace rigmap {
namespace {

std::array<int, 3> DrawSample(std::mt19937& random, int count) {
  std::uniform_int_distribution<int> draw(0, count - 1);
  std::array<int, 3> sample{draw(random), draw(random), draw(random)};
  while (sample[1] == sample[0]) sample[1] = draw(random);
  while (sample[2] == sample[0] || sample[2] == sample[1]) sample[2] = draw(random);
  return sample;
}

std::vector<PointSighting> OfKnownDepth(std::span<const PointSighting> sightings) {
  std::vector<PointSighting> known;
  std::ranges::copy_if(sightings, std::back_inserter(known), [](const PointSighting& sighting) {
    return DepthShare(sighting) <= kKnownShare;
  });
  return known;
}

// The best of many motions by the sightings of a problem, each refined on them.
class BestMotion {
 public:
  explicit BestMotion(const PoseProblem& problem) : problem_(problem) {}

  void Offer(Rigid3 motion) {
    if (problem_.Refine(motion)) OfferAsItIs(motion);
  }

  void OfferAsItIs(const Rigid3& motion) {
    const double cost = problem_.Cost(motion, cost_);
    if (!(cost < cost_)) return;
    cost_ = cost;
    motion_ = motion;
  }

  const std::optional<Rigid3>& motion() const { return motion_; }
  double cost() const { return cost_; }

 private:
  const PoseProblem& problem_;
  std::optional<Rigid3> motion_;
  double cost_ = std::numeric_limits<double>::infinity();
};

// Offers both the motions that three of the sightings tell, which are those of the first.
void OfferSamples(std::span<const PointSighting> sightings, double max_squared, int max_samples,
                  BestMotion& best_of_them, BestMotion& best) {
  const int count = static_cast<int>(sightings.size());
  // Enough samples to meet three inliers once with 99.9 %, given the share that the best explains.
  std::mt19937 random(static_cast<unsigned>(count));
  for (int sample = 0; sample < max_samples; ++sample) {
    const double inlier_share = 1.0 - std::min(1.0, best_of_them.cost() / (count * max_squared));
    const double miss = 1.0 - std::pow(inlier_share, 3);
    if (miss < 1.0 && sample * std::log(std::max(miss, 1e-9)) < std::log(1e-3)) break;
    for (const Rigid3& motion : ThreePointPoses(sightings, DrawSample(random, count))) {
      best_of_them.OfferAsItIs(motion);
      best.OfferAsItIs(motion);
    }
  }
}

// What of a motion the depths tell of the points that agree on it.
class AgreeingDepths {
 public:
  AgreeingDepths(std::span<const PointSighting> sightings, const std::vector<bool>& inliers) {
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (inliers[i]) shares_.push_back(DepthShare(sightings[i]));
    }
  }

  bool TellMoreThanTurns() const {
    return AreSomeNear() || 2 * CountWithin(kKnownShare) >= std::ssize(shares_);
  }

  double MetresSigma() const { return AreSomeNear() || shares_.empty() ? 0.0 : Median(shares_); }

 private:
  bool AreSomeNear() const {
    constexpr int kLeastNear = 6;
    constexpr double kNearShare = 0.1;
    return CountWithin(kNearShare) >= kLeastNear;
  }

  std::ptrdiff_t CountWithin(double share) const {
    return std::ranges::count_if(shares_, [&](double own) { return own <= share; });
  }

  std::vector<double> shares_;
};

}  // namespace

std::optional<StereoPose> EstimateStereoPose(std::span<const PointSighting> sightings,
                                             const StereoRig& rig, std::span<const Rigid3> guesses,
                                             const StereoPoseOptions& options) {
  const std::vector<PointSighting> known = OfKnownDepth(sightings);
  if (std::ssize(sightings) < options.min_inliers || known.size() < 4) return std::nullopt;
  const PoseProblem problem(sightings, rig, options), of_known(known, rig, options);
  BestMotion best(problem), best_of_known(of_known);
  for (const Rigid3& guess : guesses) {
    best.Offer(guess);
    best_of_known.Offer(guess);
  }
  OfferSamples(known, problem.MaxSquared(), options.max_samples, best_of_known, best);
  // Three near points tell a turn so roughly that all far ones may contradict it.
  if (best_of_known.motion()) best.Offer(*best_of_known.motion());
  if (!best.motion()) return std::nullopt;
  Rigid3 motion = *best.motion();
  const auto normal = problem.Refine(motion);
  if (!normal) return std::nullopt;
  StereoPose result = problem.Judge(motion, *normal);
  if (result.inlier_count < options.min_inliers) return std::nullopt;
  const AgreeingDepths depths(sightings, result.inliers);
  if (!depths.TellMoreThanTurns()) return std::nullopt;
  result.metres_sigma = depths.MetresSigma();
  return result;
}

}  // namespace rigmap
