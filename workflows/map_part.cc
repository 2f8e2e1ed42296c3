#include "workflows/map_part.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "adjustment/free_adjustment.h"
#include "gates/gates.h"
#include "scale/baseline_scale.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

Gates Judge(const MappingResult& mapped, const GraphWithPoses& input, const PartOptions& options) {
  const PlacedKeyframes placed =
      PlaceModels(mapped.models, input.world_from_left, input.rig, options.scale);
  return JudgeMapping(&placed, options.gates.mapping);
}

}  // namespace

MappingResult MapPart(const ColmapInstallation& colmap, const GraphWithPoses& input,
                      const MappingPaths& paths, const PartOptions& options, int threads) {
  const auto map = [&](MappingMethod method, const fs::path& models) {
    MappingOptions how = options.mapping;
    how.method = method;
    MappingPaths where = paths;
    where.models = models;
    MappingResult mapped = MapKeyframes(colmap, input, where, how, threads);
    // Poses of the odometry agree with the rig whatever the images say: let these speak.
    if (mapped.method == MappingMethod::kTriangulate) {
      for (SparseModel& model : mapped.models) {
        model = AdjustFreely(model, input.rig, options.matching.verification.min_inliers, {});
      }
    }
    return mapped;
  };
  MappingResult first = map(options.mapping.method, paths.models);
  const Gates gates = Judge(first, input, options);
  if (first.method != MappingMethod::kSeeded || AllPassed(gates)) return first;
  const std::string reason = FailureReason(gates);
  spdlog::warn("{}; triangulating the odometric poses instead", reason);
  const fs::path aside = paths.scratch / "other-models";
  MappingResult second = map(MappingMethod::kTriangulate, aside);
  if (!AllPassed(Judge(second, input, options))) {
    first.remarks.push_back(
        fmt::format("{}; triangulating the odometric poses instead did not mend it", reason));
    return first;
  }
  fs::remove_all(paths.models);
  fs::rename(aside, paths.models);
  second.remarks.push_back(
      fmt::format("{}, so the odometric poses were triangulated instead", reason));
  return second;
}

}  // namespace rigmap
