// The techniques, each a composition of stages (docs/stages.md).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "workflows/part_options.h"
#include "workflows/stages/inputs.h"

namespace rigmap {

// COLMAP maps the keyframes, the rig gives metres and holds while all is adjusted, depth maps are
// fused on the adjusted poses.
StageGraph RigRecipe(const Dataset& dataset, const DatasetContent& content,
                     const PartOptions& options);

// The plainest reading of the task: COLMAP maps, the baseline gives metres, depth maps are fused on
// these poses. Nothing is adjusted after the mapping. Throws UsageError where mapping.method is
// none.
StageGraph ColmapRecipe(const Dataset& dataset, const DatasetContent& content,
                        const PartOptions& options);

// Structure from motion alone: left and right images as free cameras with COLMAP's own matches, the
// scale at the end by the mean left-right distance. No map.
StageGraph SfmRecipe(const Dataset& dataset, const DatasetContent& content,
                     const PartOptions& options);

// The same poses, with depth maps fused on them; frames whose depth deviates are left out.
StageGraph CombinedRecipe(const Dataset& dataset, const DatasetContent& content,
                          const PartOptions& options);

// Visual odometry alone, depth maps fused on its poses: no mapping, no adjustment.
StageGraph VisualOdometryRecipe(const Dataset& dataset, const DatasetContent& content,
                                const PartOptions& options);

// The same on corners followed from frame to frame (KLT) instead of descriptors.
StageGraph KltRecipe(const Dataset& dataset, const DatasetContent& content,
                     const PartOptions& options);

// The rover's wheels, gyro and inclinometer alone; depth maps fused on their poses.
StageGraph WheelsRecipe(const Dataset& dataset, const DatasetContent& content,
                        const PartOptions& options);

// These fused with visual odometry by a Kalman filter and smoother.
StageGraph FilterRecipe(const Dataset& dataset, const DatasetContent& content,
                        const PartOptions& options);

// Clouds of single frames chained by ICP, laid over each other.
StageGraph IcpRecipe(const Dataset& dataset, const DatasetContent& content,
                     const PartOptions& options);

// As --technique names them.
enum class Technique {
  kRig,
  kColmap,
  kSfm,
  kCombined,
  kIcp,
  kVisualOdometry,
  kKlt,
  kWheels,
  kFilter
};
constexpr auto NamesOf(Technique) {
  return std::array{"rig", "colmap", "sfm", "combined", "icp", "vo", "klt", "wheels", "filter"};
}
// Throws UsageError listing what there is, in the name of the option that was given.
Technique ParseTechnique(const std::string& name, const char* option = "--technique");

StageGraph MakeRecipe(Technique technique, const Dataset& dataset, const DatasetContent& content,
                      const PartOptions& options);

// Everything that any technique may leave in an output folder beside summary and options.
std::vector<std::string> KnownOutputs();
// Stages of a technique, in order.
std::vector<std::string> StageNames(Technique technique);

}  // namespace rigmap
