#include "workflows/mapping_recipe.h"

#include "workflows/stages/matching.h"
#include "workflows/stages/scale.h"

namespace rigmap {

MappedKeyframes AddMappedKeyframes(StageGraph& g, const PartOptions& o, const MappingInputs& in) {
  const auto& [dataset, colmap, features, odometry] = in;
  // verified correspondences -> COLMAP's database -> poses in COLMAP's gauge -> metres
  const auto matches =
      g.AddStage(Matching(), Reading(o.matching, o.features, o.masks), dataset, features, odometry);
  const auto graph =
      g.AddStage(Database(), Reading(o.keyframe_graph), colmap, dataset, odometry, matches);
  const auto models = g.AddStage(Mapping(), Reading(o.mapping, o.matching.verification, o.scale),
                                 colmap, dataset, odometry, matches, graph);
  const auto aligned = g.AddStage(Scale(), Reading(), odometry, graph, models);
  return {matches, graph, models, aligned};
}

}  // namespace rigmap
