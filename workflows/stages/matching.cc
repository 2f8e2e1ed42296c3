#include "workflows/stages/matching.h"

#include <algorithm>

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

Correspondences MakeMatches(const StageContext&, const Dataset& dataset,
                            const FeatureStore& features, const Odometry& odometry,
                            const MatchingOptions& options) {
  return MatchFrames(odometry, features.AsSource(), dataset.rig, options);
}

Report ReportMatches(const Correspondences& found, const Dataset&, const FeatureStore&,
                     const Odometry&) {
  return {{"revisits",
           {{"pairs", found.loop_closures.size()},
            {"by_appearance",
             std::ranges::count(found.loop_closures, true, &LoopClosure::by_appearance)}}}};
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
