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

// Visual odometry alone, depth maps fused on its poses: no mapping, no adjustment.
StageGraph VisualOdometryRecipe(const Dataset& dataset, const DatasetContent& content,
                                const PartOptions& options);

// Clouds of single frames chained by ICP, laid over each other.
StageGraph IcpRecipe(const Dataset& dataset, const DatasetContent& content,
                     const PartOptions& options);

// As --technique names them.
enum class Technique { kRig, kVisualOdometry, kIcp };
constexpr auto NamesOf(Technique) { return std::array{"rig", "vo", "icp"}; }
// Throws UsageError listing what there is.
Technique ParseTechnique(const std::string& name);

StageGraph MakeRecipe(Technique technique, const Dataset& dataset, const DatasetContent& content,
                      const PartOptions& options);

// Everything that any technique may leave in an output folder beside summary and options.
std::vector<std::string> KnownOutputs();
// Stages of a technique, in order.
std::vector<std::string> StageNames(Technique technique);

}  // namespace rigmap
