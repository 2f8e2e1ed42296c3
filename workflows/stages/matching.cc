#include "workflows/stages/matching.h"

#include <algorithm>

#include "core/statistics.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/feature_sampler.h"

namespace rigmap {
namespace {

Correspondences MakeMatches(const StageContext&, const Dataset& dataset,
                            const FeatureStore& features, const Odometry& odometry,
                            const MatchingOptions& options, const FeatureOptions& of_features,
                            const MaskOptions& masks) {
  return MatchFrames(odometry, features.AsSource(), dataset.rig, options,
                     SamplerOf(dataset, dataset.rig, features.rig_fixed(), of_features, masks));
}

Report ReportMatches(const Correspondences& found, const Dataset&, const FeatureStore&,
                     const Odometry&) {
  Report report{{"revisits",
                 {{"pairs", found.loop_closures.size()},
                  {"by_appearance",
                   std::ranges::count(found.loop_closures, true, &LoopClosure::by_appearance)}}}};
  std::vector<std::size_t> keypoints, matches;
  for (const auto& of_frame : found.features) keypoints.push_back(of_frame.size());
  for (const FramePair& pair : found.pairs) matches.push_back(pair.matches.size());
  if (!keypoints.empty()) report["matches"]["keypoints_median"] = Median(std::move(keypoints));
  report["matches"]["pairs"] = matches.size();
  if (!matches.empty()) report["matches"]["matches_median"] = Median(std::move(matches));
  return report;
}

}  // namespace

MatchingStage Matching() {
  return {.name = "matching",
          .about =
              "verified correspondences of neighbours and loop closures, refined to the first view "
              "of each ground point",
          .code = CodeHere(),
          .make = MakeMatches,
          .report = ReportMatches};
}

}  // namespace rigmap
