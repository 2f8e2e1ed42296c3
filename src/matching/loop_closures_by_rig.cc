#include "matching/loop_closures_by_rig.h"

#include <algorithm>
#include <array>
#include <map>

#include "correspondence/sightings.h"
#include "correspondence/stereo_pose.h"
#include "matching/internal/pair_matcher.h"

namespace rigmap {
namespace {

std::vector<FeatureMatch> MatchesOf(const FramePair& pair) {
  std::vector<FeatureMatch> matches;
  for (const auto& [in_a, in_b] : pair.matches) {
    matches.push_back({static_cast<int>(in_a), static_cast<int>(in_b)});
  }
  return matches;
}

}  // namespace

std::vector<LoopClosure> LoopClosuresByRig(const Correspondences& matches, const StereoRig& rig,
                                           const MatchingOptions& options) {
  std::map<std::pair<int, int>, const FramePair*> pairs;
  for (const FramePair& pair : matches.pairs) pairs[{pair.a, pair.b}] = &pair;
  std::vector<LoopClosure> closures;
  for (const LoopClosure& found : matches.loop_closures) {
    const auto points =
        TriangulateFeatures(matches.features[found.a], rig, options.disparity_noise_px);
    const auto seen = SightingsOf(MatchesOf(*pairs.at({found.a, found.b})), points,
                                  matches.features[found.b], rig);
    const auto pose = EstimateStereoPose(seen.sightings, rig, std::array{found.b_from_a},
                                         PairPoseOptions(options));
    if (!pose) continue;
    closures.push_back(
        {found.a, found.b, pose->current_from_reference, pose->covariance, found.by_appearance});
  }
  return closures;
}

}  // namespace rigmap
