#include "matching/internal/pair_refiner.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "correspondence/ground_warp.h"
#include "correspondence/sightings.h"
#include "geometry/tile_index.h"
#include "matching/internal/pair_matcher.h"

namespace rigmap {
namespace {

// Expected growth of a patch from a to b: the nearer, the larger.
double Growth(const StereoPoint& in_a, const Rigid3& b_from_a) {
  const double depth_in_b = (b_from_a * in_a.x_in_left).z();
  return std::clamp(in_a.x_in_left.z() / std::max(depth_in_b, 1e-6), 0.5, 2.0);
}

// Half the window that is aligned: what is nearer shows half of the same ground.
constexpr double kApart_px = 6.0;

bool HoldsWindow(const Camera& camera, const Eigen::Vector2d& pixel) {
  constexpr double kMargin_px = 8.0;  // half a window and how far it may shift
  return pixel.minCoeff() >= kMargin_px && pixel.x() < camera.width - kMargin_px &&
         pixel.y() < camera.height - kMargin_px;
}

}  // namespace

struct PairRefiner::Sides {
  MatchedFrame &fixed, &moving;
  int fixed_frame = 0, moving_frame = 0;
  Rigid3 moving_from_fixed;
  bool backwards = false;  // a is the one that moves

  template <class Index>
  std::pair<Index, Index> InOrder(Index in_fixed, Index in_moving) const {
    return backwards ? std::pair(in_moving, in_fixed) : std::pair(in_fixed, in_moving);
  }
};

// The frame that was not matched with others before is aligned: the one that is no keyframe or else
// the later one.
PairRefiner::Sides PairRefiner::SidesOf(const Pair& pair) const {
  if (odometry_[pair.a].keyframe) return {pair.in_a, pair.in_b, pair.a, pair.b, pair.b_from_a};
  return {pair.in_b, pair.in_a, pair.b, pair.a, pair.b_from_a.Inverse(), true};
}

FramePair PairRefiner::Refine(const Pair& pair, const std::vector<FeatureMatch>& matches,
                              bool returned) const {
  const Sides sides = SidesOf(pair);
  FeatureRefinement& moving = sides.moving.refinement;
  // No feature stands in two matches, so that each task has its own.
  std::vector<char> agrees(matches.size(), 0);
  tbb::parallel_for(std::size_t{0}, matches.size(), [&](std::size_t i) {
    const auto [in_fixed, in_moving] = sides.backwards ? std::pair(matches[i].b, matches[i].a)
                                                       : std::pair(matches[i].a, matches[i].b);
    agrees[i] = moving.aligned[in_moving] ||
                AlignWithReference(sides.fixed.refinement, in_fixed, moving, in_moving,
                                   Expected(sides, in_fixed, returned), options_);
  });
  FramePair result{pair.a, pair.b, {}};
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (agrees[i]) result.matches.emplace_back(matches[i].a, matches[i].b);
  }
  return result;
}

// How the feature's reference patch, in the frame that is held, will look in the other: bent as
// its ground lies; turned and stretched so, too, if it may be seen from another side or much
// nearer; else grown only.
ExpectedView PairRefiner::Expected(const Sides& sides, int feature, bool turned) const {
  MatchedFrame& fixed = sides.fixed;
  const auto& point = fixed.points[feature];
  if (!point) return {};
  ExpectedView expected{Growth(*point, sides.moving_from_fixed) * Eigen::Matrix2d::Identity()};
  const auto ground_here = [&] {
    return GroundAround(fixed.refinement.found.features, fixed.points, feature, sides.fixed_frame);
  };
  auto& ground = fixed.refinement.references[feature].ground;
  if (!ground) ground = ground_here();
  if (!ground) return expected;
  const Camera& camera = rig_.left.camera;
  expected.depth_change = DepthChange(*ground, camera);
  const Rigid3 moving_from_source =
      sides.moving_from_fixed * OdometricStep(odometry_, sides.fixed_frame, ground->frame);
  if (const auto bent = GroundWarp(*ground, moving_from_source, camera)) {
    expected.bend = bent->bend;
  }
  if (!turned) return expected;
  const auto here = ground_here();
  const auto warp = here ? GroundWarp(*here, sides.moving_from_fixed, camera) : std::nullopt;
  if (warp) expected.later_from_earlier = warp->linear;
  return expected;
}

bool PairRefiner::IsFew(std::size_t matches, const Sides& sides) const {
  // Of what a motion needs: real drives have as many nearly everywhere, flat sand gains by more.
  constexpr std::size_t kEnoughTimes = 6;
  if (matches < kEnoughTimes * static_cast<std::size_t>(options_.verification.min_inliers)) {
    return true;
  }
  const auto predicted = PredictedPixels(sides.fixed.points, sides.moving_from_fixed, rig_);
  const auto in_view = std::ranges::count_if(
      predicted, [&](const auto& pixel) { return pixel && rig_.left.camera.Contains(*pixel); });
  return static_cast<double>(matches) < options_.carry_below_share * static_cast<double>(in_view);
}

PairRefiner::Carried PairRefiner::SampleThere(const Sides& sides, const FramePair& refined) const {
  std::vector<char> is_matched(sides.fixed.points.size(), 0);
  for (const auto& [a, b] : refined.matches) is_matched[sides.backwards ? b : a] = 1;
  std::set<TileIndex> taken;
  const FeatureRefinement& known = sides.moving.refinement;
  for (std::size_t i = 0; i < known.refined.size(); ++i) {
    if (known.aligned[i]) taken.insert(TileAt(known.refined[i].left, kApart_px));
  }
  const auto predicted = PredictedPixels(sides.fixed.points, sides.moving_from_fixed, rig_);
  std::vector<int> asked;
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    if (is_matched[i] || !predicted[i] || !HoldsWindow(rig_.left.camera, *predicted[i])) continue;
    if (!taken.insert(TileAt(*predicted[i], kApart_px)).second) continue;
    asked.push_back(static_cast<int>(i));
    pixels.push_back(*predicted[i]);
  }
  Carried carried;
  if (pixels.empty()) return carried;
  const auto sampled = sample_(sides.moving_frame, pixels);
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    if (!sampled[i]) continue;
    carried.of_fixed.push_back(asked[i]);
    carried.features.features.push_back(sampled[i]->feature);
    carried.features.patches.push_back(sampled[i]->patch);
  }
  return carried;
}

// Of those aligned the ones that both eyes see where one motion, which the matches before agree on,
// shows them; b is their index among those carried.
std::vector<FeatureMatch> PairRefiner::Agreeing(const Sides& sides, const FramePair& refined,
                                                const std::vector<int>& of_fixed,
                                                const std::vector<char>& is_aligned,
                                                const FeatureRefinement& there) const {
  std::vector<Feature> seen = there.refined;
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < of_fixed.size(); ++i) {
    if (is_aligned[i]) matches.push_back({of_fixed[i], static_cast<int>(i)});
  }
  for (const auto& [a, b] : refined.matches) {
    const auto [in_fixed, in_moving] = sides.backwards ? std::pair(b, a) : std::pair(a, b);
    matches.push_back({static_cast<int>(in_fixed), static_cast<int>(seen.size())});
    seen.push_back(sides.moving.refinement.refined[in_moving]);
  }
  const auto sightings = SightingsOf(matches, sides.fixed.points, seen, rig_);
  const auto pose = EstimateStereoPose(
      sightings.sightings, rig_, std::array{sides.moving_from_fixed}, PairPoseOptions(options_));
  if (!pose) return {};
  std::vector<FeatureMatch> agreeing = sightings.Agreeing(*pose);
  const int carried = static_cast<int>(of_fixed.size());
  std::erase_if(agreeing, [&](const FeatureMatch& match) { return match.b >= carried; });
  return agreeing;
}

void PairRefiner::CarryMore(const Pair& pair, FramePair& refined) const {
  const Sides sides = SidesOf(pair);
  if (!sample_ || options_.carry_below_share == 0.0 || !IsFew(refined.matches.size(), sides))
    return;
  Carried carried = SampleThere(sides, refined);
  FeatureRefinement there = StartRefinement(std::move(carried.features));
  std::vector<char> agrees(carried.of_fixed.size(), 0);
  tbb::parallel_for(std::size_t{0}, agrees.size(), [&](std::size_t i) {
    const int feature = carried.of_fixed[i];
    agrees[i] = AlignWithReference(sides.fixed.refinement, feature, there, static_cast<int>(i),
                                   Expected(sides, feature, true), options_);
  });
  for (const FeatureMatch& match : Agreeing(sides, refined, carried.of_fixed, agrees, there)) {
    const std::size_t index = TakeOver(there, match.b, sides.moving.refinement);
    sides.moving.points.push_back(
        TriangulateFeatures({there.refined[match.b]}, rig_, options_.disparity_noise_px).front());
    refined.matches.push_back(
        sides.InOrder(static_cast<std::uint32_t>(match.a), static_cast<std::uint32_t>(index)));
  }
}

}  // namespace rigmap
