#include "core/error.h"
#include "workflows/mapping_recipe.h"
#include "workflows/recipes.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/mapped_part.h"
#include "workflows/stages/odometry.h"
#include "workflows/surface_recipe.h"

namespace rigmap {

StageGraph ColmapRecipe(const Dataset& data, const DatasetContent& data_content,
                        const PartOptions& o) {
  if (o.mapping.method == MappingMethod::kNone) {
    throw UsageError("mapping.method: expected a way to map for the technique colmap, found none");
  }
  StageGraph g;
  const auto [dataset, content, truth, fixes, colmap] =
      AddPartInputs(g, data, data_content, o.colmap);

  // images -> keypoints with stereo matches -> metric motion from frame to keyframe
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), dataset, content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), dataset, features);

  // verified correspondences -> COLMAP's database -> poses in COLMAP's gauge -> metres
  const auto keyframes = AddMappedKeyframes(g, o, {dataset, colmap, features, odometry});

  // laid into the world as they are
  const auto part = g.AddStage(MappedTrajectory(), Reading(o.mapping), dataset, odometry,
                               keyframes.graph, keyframes.models, keyframes.aligned);
  const auto gates = g.AddCheck(MappedGates(),
                                Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment,
                                        o.gates.calibration, o.adjustment),
                                dataset, found, keyframes.aligned, part);
  const auto posed = g.AddView(PosedByAdjustment, dataset, part);

  // depth of the keyframes, fused on the poses -> coloured map, judged
  AddSurface(g, o, {dataset, content, truth, fixes, found, posed, gates});
  return g;
}

}  // namespace rigmap
