#include "workflows/recipes.h"
#include "workflows/stages/dead_reckoning.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/merging.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/registration.h"
#include "workflows/stages/trajectory.h"
#include "workflows/surface_recipe.h"

namespace rigmap {

StageGraph IcpRecipe(const Dataset& data, const DatasetContent& data_content,
                     const PartOptions& o) {
  StageGraph g;
  const auto [dataset, content, truth, fixes, colmap] =
      AddPartInputs(g, data, data_content, o.colmap);

  // images -> what to compare with, and to begin from if asked for
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), dataset, content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), dataset, features);

  auto guess = odometry;
  if (Resolved(o.registration).first_guess == FirstGuess::kWheels) {
    const auto rover = g.AddStage(DeadReckoning(), Reading(o.dead_reckoning), dataset);
    guess = g.AddView(StepsOfRover, rover);
  }

  // images -> depth of every frame -> clouds, each registered against those before
  const auto depths = g.AddStage(FrameDepths(), Reading(o.dense, o.masks, o.voxel), dataset,
                                 content, found, features);
  const auto registration = g.AddStage(
      CloudRegistration(), Reading(o.clouds, o.registration, o.odometry), dataset, guess, depths);
  const auto motion = g.AddView(RegisteredMotion, registration);

  // laid into the world as they are
  const auto part = g.AddStage(OdometricTrajectory(), Reading(o.odometry, o.adjustment), dataset,
                               features, motion);
  const auto gates = g.AddCheck(RegistrationGates(),
                                Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment,
                                        o.gates.calibration, o.gates.registration),
                                dataset, found, odometry, registration, part);
  const auto posed = g.AddView(PosedByOdometry, dataset, part);

  // the same clouds, merged -> coloured map, judged
  const SurfaceInputs surface{dataset, content, truth, fixes, found, posed, gates};
  const auto depth_gates = AddDepthProducts(g, o, surface, depths);
  const auto map = g.AddStage(CloudMerging(), Reading(o.clouds, o.merging), dataset, posed, depths);
  AddMapProducts(g, o, surface, depth_gates, map);
  return g;
}

}  // namespace rigmap
