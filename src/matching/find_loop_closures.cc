#include "matching/internal/find_loop_closures.h"

#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <span>

#include "core/statistics.h"
#include "matching/internal/loop_closure_motion.h"
#include "matching/internal/pair_selection.h"
#include "matching/internal/place_index.h"
#include "matching/internal/vocabulary.h"

namespace rigmap {
namespace {

// Two keyframes (indices into the list of them) and what their matches say.
struct Proposal {
  int earlier = 0, later = 0;
  StereoPose motion;
};

class LoopClosureFinder {
 public:
  LoopClosureFinder(const LoopClosureSearch& search, const MatchingOptions& options)
      : search_(search),
        options_(options),
        keyframes_(Keyframes(search.odometry)),
        loop_candidates_(LoopCandidatesBefore(keyframes_, search.odometry, search.sample_points,
                                              search.rig, options)) {}

  std::vector<LoopClosure> Find() const {
    if (std::ranges::all_of(loop_candidates_, [](int count) { return count == 0; })) return {};
    const std::vector<Proposal> proposals = Propose();
    std::vector<LoopClosure> found;
    for (auto first = proposals.begin(); first != proposals.end();) {
      const auto end = std::find_if(first, proposals.end(),
                                    [&](const Proposal& p) { return p.later != first->later; });
      AddBest({first, end}, proposals, found);
      first = end;
    }
    return found;
  }

 private:
  // Of the proposals for one keyframe those with the most matches that are proved.
  void AddBest(std::vector<Proposal> own, const std::vector<Proposal>& all,
               std::vector<LoopClosure>& found) const {
    std::erase_if(own, [&](const Proposal& p) { return !Proved(p, all); });
    std::ranges::stable_sort(own, std::ranges::greater(),
                             [](const Proposal& p) { return p.motion.inlier_count; });
    own.resize(std::min(own.size(), static_cast<std::size_t>(options_.max_revisits)));
    for (const Proposal& p : own) {
      found.push_back({keyframes_[p.earlier], keyframes_[p.later], p.motion.current_from_reference,
                       p.motion.covariance, true});
    }
  }

  Vocabulary Learn() const {
    constexpr std::size_t kSample = 60'000, kPerKeyframe = 750;
    const std::size_t share = std::min(kPerKeyframe, kSample / keyframes_.size() + 1);
    std::vector<std::vector<Descriptor>> of_keyframe(keyframes_.size());
    tbb::parallel_for(std::size_t{0}, keyframes_.size(), [&](std::size_t k) {
      const FrameFeatures features = search_.features(keyframes_[k]);
      const std::size_t step = features.descriptors.size() / share + 1;
      for (std::size_t i = 0; i < features.descriptors.size(); i += step) {
        of_keyframe[k].push_back(features.descriptors[i]);
      }
    });
    std::vector<Descriptor> sample;
    for (const auto& some : of_keyframe) sample.insert(sample.end(), some.begin(), some.end());
    return Vocabulary(sample);
  }

  PlaceIndex IndexPlaces(const Vocabulary& vocabulary) const {
    std::vector<std::vector<int>> words(keyframes_.size());
    tbb::parallel_for(std::size_t{0}, words.size(), [&](std::size_t i) {
      for (const Descriptor& descriptor : search_.features(keyframes_[i]).descriptors) {
        words[i].push_back(vocabulary.WordOf(descriptor));
      }
    });
    return {words, vocabulary.word_count()};
  }

  // Earlier keyframes that look most like k, best first.
  std::vector<int> MostAlike(const PlaceIndex& index, int k) const {
    const std::vector<float> likeness = index.Likeness(k);
    std::vector<std::pair<float, int>> ranked;
    for (int earlier = 0; earlier < loop_candidates_[k]; ++earlier) {
      ranked.emplace_back(-likeness[earlier], earlier);
    }
    const auto count =
        std::min(ranked.size(), static_cast<std::size_t>(options_.revisit_candidates));
    std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count),
                      ranked.end());
    std::vector<int> best;
    for (std::size_t i = 0; i < count; ++i) best.push_back(ranked[i].second);
    return best;
  }

  SearchedFrame View(int k, const Vocabulary& vocabulary) const {
    SearchedFrame view{.features = search_.features(keyframes_[k])};
    view.points =
        TriangulateFeatures(view.features.features, search_.rig, options_.disparity_noise_px);
    for (const Descriptor& descriptor : view.features.descriptors) {
      view.groups.push_back(vocabulary.BranchOf(descriptor));
    }
    return view;
  }

  // Two keyframes that look alike.
  struct Likely {
    int earlier = 0, later = 0;
  };

  // Of the keyframes that these show; what is held already is not made again.
  void Hold(std::span<const Likely> shown, const Vocabulary& vocabulary,
            std::map<int, SearchedFrame>& held) const {
    std::set<int> needed;
    for (const Likely& pair : shown) needed.insert({pair.earlier, pair.later});
    std::erase_if(held, [&](const auto& entry) { return !needed.contains(entry.first); });
    std::erase_if(needed, [&](int k) { return held.contains(k); });
    const std::vector<int> missing(needed.begin(), needed.end());
    std::vector<SearchedFrame> views(missing.size());
    tbb::parallel_for(std::size_t{0}, missing.size(),
                      [&](std::size_t i) { views[i] = View(missing[i], vocabulary); });
    for (std::size_t i = 0; i < missing.size(); ++i) held.emplace(missing[i], std::move(views[i]));
  }

  // In order of the later keyframe.
  std::vector<Proposal> Propose() const {
    constexpr int kTogether = 4;  // keyframes; the next ones look like the same again
    const Vocabulary vocabulary = Learn();
    const PlaceIndex index = IndexPlaces(vocabulary);
    std::vector<Proposal> proposals;
    std::map<int, SearchedFrame> held;
    const int count = static_cast<int>(keyframes_.size());
    for (int first = 0; first < count; first += kTogether) {
      std::vector<Likely> likely;
      for (int k = first; k < std::min(first + kTogether, count); ++k) {
        for (const int earlier : MostAlike(index, k)) likely.push_back({earlier, k});
      }
      Hold(likely, vocabulary, held);
      std::vector<std::optional<StereoPose>> motions(likely.size());
      tbb::parallel_for(std::size_t{0}, likely.size(), [&](std::size_t i) {
        motions[i] = MotionWithoutPrediction(held.at(likely[i].earlier), held.at(likely[i].later),
                                             search_.rig, options_);
      });
      for (std::size_t i = 0; i < likely.size(); ++i) {
        const auto& [earlier, later] = likely[i];
        if (!motions[i] || !Sharp(motions[i]->covariance, later)) continue;
        spdlog::info("{} may show what {} shows: {} matches agree", keyframes_[later],
                     keyframes_[earlier], motions[i]->inlier_count);
        proposals.push_back({earlier, later, *motions[i]});
      }
    }
    return proposals;
  }

  // Far things alone agree with many motions: one that is known must tell where the ground is seen.
  bool Sharp(const Matrix6d& covariance, int k) const {
    std::vector<double> depths;
    for (const auto& x : search_.sample_points[keyframes_[k]]) depths.push_back(x.z());
    if (depths.empty()) return false;
    const double sigma_px = std::sqrt(covariance.topLeftCorner<3, 3>().trace()) *
                            search_.rig.left.camera.MeanFocal() / Median(std::move(depths));
    return options_.max_sigmas * sigma_px <= options_.search_radius_px;
  }

  bool Proved(const Proposal& proposal, const std::vector<Proposal>& all) const {
    if (proposal.motion.inlier_count >= options_.sure_revisit_inliers) return true;
    return std::ranges::any_of(all, [&](const Proposal& other) {
      return other.later != proposal.later &&
             std::abs(other.later - proposal.later) <= options_.neighbours &&
             std::abs(other.earlier - proposal.earlier) <= options_.neighbours &&
             SameMotion(proposal, other);
    });
  }

  // Whether the other's motion, carried along by the odometry, shows the points where this one
  // does: within what the odometry may be off, as the matching of neighbours takes it.
  bool SameMotion(const Proposal& one, const Proposal& other) const {
    const int a = keyframes_[one.earlier], b = keyframes_[one.later];
    const Rigid3 carried = OdometricMotion(keyframes_[other.later], b) *
                           other.motion.current_from_reference *
                           OdometricMotion(a, keyframes_[other.earlier]);
    const Camera& camera = search_.rig.left.camera;
    std::vector<double> distances_px;
    for (const auto& x : search_.sample_points[a]) {
      const auto here = Project(camera, one.motion.current_from_reference * x);
      const auto there = Project(camera, carried * x);
      if (!here || !camera.Contains(*here)) continue;
      distances_px.push_back(there ? (*here - *there).norm() : camera.width);
    }
    const int steps = std::abs(one.earlier - other.earlier) + std::abs(one.later - other.later);
    return !distances_px.empty() &&
           Median(std::move(distances_px)) <= options_.search_radius_px * steps;
  }

  Rigid3 OdometricMotion(int from, int to) const {
    return search_.odometry[to].world_from_left.Inverse() * search_.odometry[from].world_from_left;
  }

  const LoopClosureSearch& search_;
  const MatchingOptions& options_;
  std::vector<int> keyframes_;
  std::vector<int> loop_candidates_;  // how many of the first keyframes, for each
};

}  // namespace

std::vector<LoopClosure> FindLoopClosures(const LoopClosureSearch& search,
                                          const MatchingOptions& options) {
  if (options.revisit_candidates == 0) return {};
  return LoopClosureFinder(search, options).Find();
}

}  // namespace rigmap
