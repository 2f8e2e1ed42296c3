#include "matching/match_frames.h"

#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <set>
#include <span>

#include "correspondence/stereo_points.h"
#include "matching/internal/find_loop_closures.h"
#include "matching/internal/pair_matcher.h"
#include "matching/internal/pair_refiner.h"
#include "matching/internal/pair_selection.h"

namespace rigmap {
namespace {

std::vector<Eigen::Vector3d> SamplePoints(const std::vector<std::optional<StereoPoint>>& points) {
  constexpr std::size_t kSamples = 100;
  std::vector<Eigen::Vector3d> present, sample;
  for (const auto& point : points) {
    if (point) present.push_back(point->x_in_left);
  }
  const std::size_t step = std::max<std::size_t>(1, present.size() / kSamples);
  for (std::size_t i = 0; i < present.size(); i += step) sample.push_back(present[i]);
  return sample;
}

Rigid3 OdometricMotion(const Odometry& odometry, int from, int to) {
  return odometry[to].world_from_left.Inverse() * odometry[from].world_from_left;
}

class FrameMatcher {
 public:
  FrameMatcher(const Odometry& odometry, const FeatureSource& features, const StereoRig& rig,
               const MatchingOptions& options, const FeatureSampler& sample)
      : odometry_(odometry),
        rig_(rig),
        options_(options),
        refiner_(odometry, rig, options, sample),
        // Pairs come in order of time, so that a frame's neighbours and loop closures are all that
        // is held.
        window_(features, rig, options.disparity_noise_px, HeldFrames()) {}

  // `returned` tells of pairs whose ground was out of view in between. Verifying takes nothing that
  // refining changes: pairs whose frames are held together are verified side by side.
  void Match(std::span<const CandidatePair> pairs,
             const std::function<bool(const CandidatePair&)>& returned) {
    while (!pairs.empty()) {
      const auto together = pairs.first(CountHeldTogether(pairs));
      std::vector<const MatchedFrame*> frames;
      for (const CandidatePair& pair : together) {
        frames.push_back(&window_.At(pair.a));
        frames.push_back(&window_.At(pair.b));
      }
      std::vector<VerifiedPair> verified(together.size());
      tbb::parallel_for(std::size_t{0}, together.size(), [&](std::size_t i) {
        verified[i] = VerifyPair(together[i], Predicted(together[i]), *frames[2 * i],
                                 *frames[2 * i + 1], rig_, options_);
      });
      for (std::size_t i = 0; i < together.size(); ++i) {
        Keep(together[i], verified[i], returned(together[i]));
      }
      pairs = pairs.subspan(together.size());
    }
  }

  Correspondences Finish() {
    result_.features = window_.Finish(static_cast<int>(odometry_.size()));
    return std::move(result_);
  }

 private:
  std::size_t HeldFrames() const {
    return static_cast<std::size_t>(options_.neighbours + 2 * options_.max_revisits + 2);
  }

  // How many of the first pairs have, between them, no more frames than are held.
  std::size_t CountHeldTogether(std::span<const CandidatePair> pairs) const {
    std::set<int> frames;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      frames.insert({pairs[i].a, pairs[i].b});
      if (i > 0 && frames.size() > HeldFrames()) return i;
    }
    return pairs.size();
  }

  // No keyframe lies between them: those further apart share less, and what they share is carried
  // from one to the next.
  bool AreNeighbours(const CandidatePair& pair) const {
    return std::none_of(odometry_.begin() + pair.a + 1, odometry_.begin() + pair.b,
                        [](const OdometryFrame& frame) { return frame.keyframe; });
  }

  Rigid3 Predicted(const CandidatePair& pair) const {
    return pair.b_from_a.value_or(OdometricMotion(odometry_, pair.a, pair.b));
  }

  void Keep(const CandidatePair& pair, const VerifiedPair& verified, bool returned) {
    if (!verified.b_from_a) return;
    const StereoPose& motion = *verified.b_from_a;
    PairRefiner::Pair frames{pair.a, pair.b, window_.At(pair.a), window_.At(pair.b),
                             returned ? motion.current_from_reference : Predicted(pair)};
    FramePair refined = refiner_.Refine(frames, verified.matches, returned);
    const std::size_t aligned = refined.matches.size();
    if (!returned && AreNeighbours(pair)) {
      frames.b_from_a = motion.current_from_reference;
      refiner_.CarryMore(frames, refined);
    }
    spdlog::info("{} {}: {} verified, {} aligned, {} carried", pair.a, pair.b,
                 verified.matches.size(), aligned, refined.matches.size() - aligned);
    // The motion is proven already: half of what that takes is enough to agree in appearance, too.
    const int enough = options_.verification.min_inliers / 2;
    if (static_cast<int>(refined.matches.size()) < enough) return;
    result_.pairs.push_back(std::move(refined));
    if (!returned) return;
    result_.loop_closures.push_back({pair.a, pair.b, motion.current_from_reference,
                                     motion.covariance, pair.b_from_a.has_value()});
  }

  const Odometry& odometry_;
  const StereoRig& rig_;
  const MatchingOptions& options_;
  PairRefiner refiner_;
  FrameWindow window_;
  Correspondences result_;
};

// For each frame the first frame of the same stretch of the way: pairs within it are no loop
// closures.
std::vector<int> FirstOfSameStretch(const Odometry& odometry,
                                    const std::vector<std::vector<Eigen::Vector3d>>& sample_points,
                                    const StereoRig& rig, const MatchingOptions& options) {
  const std::vector<int> keyframes = Keyframes(odometry);
  const std::vector<int> loop_candidates =
      LoopCandidatesBefore(keyframes, odometry, sample_points, rig, options);
  std::vector<int> first(odometry.size(), 0);
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    first[keyframes[k]] = keyframes[loop_candidates[k]];
  return first;
}

}  // namespace

Correspondences MatchFrames(const Odometry& odometry, const FeatureSource& features,
                            const StereoRig& rig, const MatchingOptions& options,
                            const FeatureSampler& sample) {
  std::vector<std::vector<Eigen::Vector3d>> sample_points(odometry.size());
  tbb::parallel_for(std::size_t{0}, odometry.size(), [&](std::size_t i) {
    if (!odometry[i].keyframe) return;
    sample_points[i] = SamplePoints(TriangulateFeatures(features(static_cast<int>(i)).features, rig,
                                                        options.disparity_noise_px));
  });
  std::vector<CandidatePair> pairs = SelectPairs(odometry, sample_points, rig, options);
  AddFoundLoopClosures(FindLoopClosures({odometry, features, sample_points, rig}, options), pairs);
  const std::vector<int> same_stretch = FirstOfSameStretch(odometry, sample_points, rig, options);
  FrameMatcher matcher(odometry, features, rig, options, sample);
  matcher.Match(pairs, [&](const CandidatePair& pair) {
    return pair.loop_closure && pair.a < same_stretch[pair.b];
  });
  return matcher.Finish();
}

}  // namespace rigmap
