#include "workflows/stages/compare_result.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/artefact.h"
#include "core/file.h"
#include "evaluation/map_metrics.h"
#include "evaluation/map_over_truth.h"
#include "evaluation/prism_metrics.h"
#include "evaluation/rock_metrics.h"
#include "evaluation/rtk_metrics.h"
#include "georeference/earth_fit.h"
#include "georeference/fix_pairs.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> TruthFolders(const fs::path& truth) {
  std::vector<fs::path> folders;
  for (const fs::path& file : TruthFiles(truth)) folders.push_back(file.parent_path());
  return folders;
}

// The truth of what was driven: a run of some frames is not judged by the rest of the way.
std::vector<TumPose> TruthDuring(const std::vector<TumPose>& estimate, std::vector<TumPose> truth,
                                 double max_dt_s) {
  const auto [first, last] = std::ranges::minmax_element(estimate, {}, &TumPose::stamp_ns);
  if (first == estimate.end()) return truth;
  const auto margin_ns = static_cast<StampNs>(1e9 * max_dt_s);
  std::erase_if(truth,
                [&, from = first->stamp_ns - margin_ns, to = last->stamp_ns + margin_ns](
                    const TumPose& pose) { return pose.stamp_ns < from || pose.stamp_ns > to; });
  return truth;
}

}  // namespace

std::vector<fs::path> TruthFiles(const fs::path& truth) {
  if (!fs::is_directory(truth)) return {truth};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(truth)) {
    fs::path file = entry.path() / "trajectory.tum";
    if (fs::exists(file)) files.push_back(std::move(file));
  }
  std::ranges::sort(files);
  return files;
}

std::vector<TumPose> ReadTruth(const fs::path& truth) {
  std::vector<TumPose> poses;
  for (const fs::path& file : TruthFiles(truth)) {
    const std::vector<TumPose> more = ReadTum(file);
    poses.insert(poses.end(), more.begin(), more.end());
  }
  std::ranges::stable_sort(poses, {}, &TumPose::stamp_ns);
  const auto repeated = std::ranges::unique(poses, {}, &TumPose::stamp_ns);
  poses.erase(repeated.begin(), repeated.end());
  return poses;
}

void RequireTruth(const fs::path& truth_path) {
  if (IsPrismFile(truth_path)) {
    ReadPrismFile(truth_path);
  } else {
    ReadTruth(truth_path);
  }
}

nlohmann::ordered_json CompareWithTruth(const std::vector<TumPose>& estimate,
                                        const fs::path& truth_path, const fs::path& map_ply,
                                        const EvaluationOptions& options) {
  if (IsPrismFile(truth_path)) return ToJson(ComparePrism(estimate, ReadPrismFile(truth_path)));
  std::vector<TumPose> path = TruthDuring(estimate, ReadTruth(truth_path), options.max_dt_s);
  const TrajectoryMetrics trajectory = CompareTrajectories(estimate, path, options);
  auto json = ToJson(trajectory);
  if (auto drift = DriftToJson(trajectory); !drift.is_null()) json["drift"] = std::move(drift);
  std::error_code ignored;
  if (!fs::exists(map_ply, ignored)) return json;
  const auto truth = ReadMapTruth(TruthFolders(truth_path), std::move(path));
  if (!truth) return json;
  const auto truth_from_world = AlignWithTruth(estimate, truth->path, options);
  if (!truth_from_world) return json;  // which the trajectory's `error` says
  const MapOverTruth map(ReadMapPoints(map_ply), *truth_from_world, *truth, ReadMapSigmas(map_ply));
  const MapMetrics metrics = CompareMap(map);
  json["map"] = ToJson(metrics);
  if (auto sigmas = SigmasToJson(metrics); !sigmas.is_null())
    json["map_sigmas"] = std::move(sigmas);
  json["rocks"] = ToJson(CompareRocks(map));
  return json;
}

std::string DoubtOfTruth(const nlohmann::ordered_json& metrics) {
  if (metrics.contains("error")) return metrics["error"];
  constexpr double kTimes = 2.0;
  const auto figure = [&](const char* name) { return metrics.value(name, 0.0); };
  const double matched = figure("coverage") * figure("gt_frames"), frames = figure("frames");
  if (metrics.contains("coverage") && kTimes * matched < frames) {
    return fmt::format("poses at {:.0f} of the result's {:.0f} moments only", matched, frames);
  }
  const double path_m = figure("path_m"), found_m = figure("est_path_m");
  if (metrics.contains("path_m") && (path_m > kTimes * found_m || found_m > kTimes * path_m)) {
    return fmt::format("a path of {:.2f} m, where the result has {:.2f} m", path_m, found_m);
  }
  return "";
}

void WarnOfTruth(const nlohmann::ordered_json& metrics, const fs::path& truth_path) {
  const std::string doubt = DoubtOfTruth(metrics);
  if (!doubt.empty()) spdlog::warn("{}: {}: of another drive?", truth_path.string(), doubt);
}

namespace {

// A trajectory laid on fixes; `described` has the keys of `rtk`.
struct OnFixes {
  RtkFit fit;
  nlohmann::ordered_json described = nlohmann::ordered_json::object();
};

OnFixes LayOnFixes(const std::vector<GnssFix>& fixes, const Trajectory& trajectory,
                   const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options) {
  // A path that strays from its fixes is known less well there than one that is to be believed, but
  // by how much it strays is just what is asked.
  const double max_place_sigma_m = EarthFitOptions().max_map_sigma_m;
  OnFixes on{AlignToRtkWeakly(fixes, trajectory, antenna_in_left, options, max_place_sigma_m)};
  if (on.fit.alignment) on.described = ToJson(*on.fit.alignment);
  if (!on.fit.why.empty()) on.described["why"] = on.fit.why;
  if (!on.fit.alignment) return on;
  const auto pairs = PairFixes(fixes, trajectory, antenna_in_left, *on.fit.alignment, options);
  if (const auto metrics = CompareRtk(pairs, *on.fit.alignment)) {
    on.described.update(ToJson(*metrics));
  }
  return on;
}

}  // namespace

nlohmann::ordered_json CompareWithFixes(const Trajectory& trajectory, const StereoRig& rig,
                                        const std::vector<GnssFix>& fixes,
                                        const RtkAlignmentOptions& options) {
  if (fixes.empty() || !rig.antenna_in_left) return nullptr;
  return LayOnFixes(fixes, trajectory, *rig.antenna_in_left, options).described;
}

nlohmann::ordered_json CompareWithSurvey(const SurveyedResult& result,
                                         const SurveyOptions& options) {
  const auto& antenna_in_left = result.rig.antenna_in_left;
  if (result.truth.fixes.empty() || !antenna_in_left) return nullptr;
  const auto [fit, described] =
      LayOnFixes(result.truth.fixes, result.trajectory, *antenna_in_left, options.alignment);
  nlohmann::ordered_json json{{"rtk", described}};
  std::error_code ignored;
  const auto& rocks = result.truth.surveyed_rocks;
  if (!fit.alignment || fit.is_weak || rocks.empty() || !fs::exists(result.map_ply, ignored))
    return json;
  json["surveyed_rocks"] = ToJson(CompareWithSurvey(SegmentRocksIn(result.map_ply, options.rocks),
                                                    {result.trajectory, result.rig},
                                                    {rocks, *fit.alignment}, options.survey));
  return json;
}

std::string DescribeTruth(const Truth& truth) {
  std::string text;
  if (!truth.path.empty()) {
    for (const fs::path& path : TruthFiles(truth.path)) text += HashFile(path);
    for (const fs::path& path : MapTruthFiles(TruthFolders(truth.path))) {
      text += fmt::format(" {}", HashFile(path));
    }
  }
  for (const GnssFix& fix : truth.fixes) {
    text +=
        fmt::format("\n{} {} {} {} {} {} {}", fix.stamp_ns, fix.status, fix.latitude_deg,
                    fix.longitude_deg, fix.altitude_m, fix.sigma_enu_m.x(), fix.sigma_enu_m.y());
    text += fmt::format(" {}", fix.sigma_enu_m.z());
  }
  for (const SurveyedLandmark& rock : truth.surveyed_rocks) {
    text += fmt::format("\n{} {} {} {}", rock.kind, rock.position.epsg, rock.position.easting_m,
                        rock.position.northing_m);
  }
  return text;
}

}  // namespace rigmap
