#include "workflows/compare_result.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/artefact.h"
#include "core/file.h"
#include "evaluation/map_metrics.h"
#include "evaluation/map_over_truth.h"
#include "evaluation/rock_metrics.h"
#include "export/ply_reader.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

RockSegmentation RocksOf(const fs::path& map_ply, const RockSegmentationOptions& options) {
  HeightGrid heights;
  PlyReader reader(map_ply);
  PointCloud block;
  while (reader.Read(block)) heights.Add(block);
  return SegmentRocks(heights, options);
}

}  // namespace

nlohmann::ordered_json CompareWithTruth(const std::vector<TumPose>& estimate,
                                        const fs::path& truth_tum, const fs::path& map_ply,
                                        const PartOptions& options) {
  auto json = ToJson(CompareTrajectories(estimate, ReadTum(truth_tum), options.evaluation));
  std::error_code ignored;
  if (!fs::exists(map_ply, ignored)) return json;
  const auto truth = ReadMapTruth(truth_tum.parent_path());
  if (!truth) return json;
  const auto truth_from_world = AlignWithTruth(estimate, truth->path, options.evaluation);
  if (!truth_from_world) return json;  // which the trajectory's `error` says
  const MapOverTruth map(ReadMapPoints(map_ply), *truth_from_world, *truth);
  json["map"] = ToJson(CompareMap(map));
  json["rocks"] = ToJson(CompareRocks(map));
  return json;
}

std::string DescribeTruth(const fs::path& truth_tum) {
  std::string text = HashText(ReadTextFile(truth_tum));
  for (const fs::path& path : MapTruthFiles(truth_tum.parent_path())) {
    text += fmt::format(" {}", HashFile(path));
  }
  return text;
}

bool HasFixes(const Dataset& dataset) {
  return !dataset.fixes.empty() && dataset.rig.antenna_in_left;
}

nlohmann::ordered_json CompareWithSurvey(const Trajectory& trajectory, const Dataset& dataset,
                                         const fs::path& map_ply, const PartOptions& options) {
  if (!HasFixes(dataset)) return nullptr;
  const RtkFit fit =
      AlignToRtk(dataset.fixes, trajectory, *dataset.rig.antenna_in_left, options.georeference);
  nlohmann::ordered_json json;
  json["rtk"] = fit.alignment ? ToJson(*fit.alignment) : nlohmann::ordered_json::object();
  if (!fit.why.empty()) json["rtk"]["why"] = fit.why;
  std::error_code ignored;
  if (!fit.alignment || dataset.surveyed_landmarks.empty() || !fs::exists(map_ply, ignored)) {
    return json;
  }
  json["surveyed_rocks"] =
      ToJson(CompareWithSurvey(RocksOf(map_ply, options.rocks), {trajectory, dataset.rig},
                               {dataset.surveyed_landmarks, *fit.alignment}, options.rock_survey));
  return json;
}

std::string DescribeSurvey(const Dataset& dataset) {
  std::string text;
  for (const GnssFix& fix : dataset.fixes) {
    text += fmt::format("{} {} {} {} {} {} {}\n", fix.stamp_ns, fix.status, fix.latitude_deg,
                        fix.longitude_deg, fix.sigma_enu_m.x(), fix.sigma_enu_m.y(),
                        fix.sigma_enu_m.z());
  }
  for (const SurveyedLandmark& rock : dataset.surveyed_landmarks) {
    text += fmt::format("{} {} {} {}\n", rock.kind, rock.position.epsg, rock.position.easting_m,
                        rock.position.northing_m);
  }
  return text;
}

}  // namespace rigmap
