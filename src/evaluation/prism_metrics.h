// How far a trajectory is from a prism on the rover that a total station tracked, seen from above.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/stamp.h"
#include "export/tum.h"

namespace rigmap {

// A prism's position in a horizontal plane of its own, metres.
struct PrismPosition {
  StampNs stamp_ns = 0;  // by the total station's clock
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

// True where the first row that is no comment holds three fields, as rows "t x y" do; a TUM file's
// hold eight. A file named groundtruth_xy.txt is one whatever it holds. Throws DataError where the
// file cannot be read.
bool IsPrismFile(const std::filesystem::path& path);

// Rows "t x y" (s, m, m), '#' starts a comment. In order of time. Throws DataError that names file
// and line for another row, a time that is no later than the one before, and fewer than two rows.
std::vector<PrismPosition> ReadPrismFile(const std::filesystem::path& path);

// A fit of the path of the prism on the body to the tracked one.
struct PrismFit {
  // track = turned by heading_rad (scale * prism seen from above) + shift.
  double heading_rad = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  Eigen::Vector3d prism_in_body = Eigen::Vector3d::Zero();
  double clock_offset_s = 0.0;      // stamp by the total station's clock minus that of the poses
  double scale = 1.0;               // truth / estimate; 1 where it was held
  std::size_t inside = 0;           // poses in the time of the track, which alone count
  double rms_m = 0.0, max_m = 0.0;  // horizontal distances of these
};

struct PrismMetrics {
  std::size_t frames = 0;  // estimated poses
  // Of what is inside, over every fifth pose, so that noise adds no length: of the track, and of
  // the body seen from above.
  double true_path_m = 0.0, estimated_path_m = 0.0;
  std::optional<PrismFit> rigid, similar;  // without, with the scale; nothing where too few match
};

// Fits heading, shift, lever arm and clock offset, and the scale apart, by least squares that
// outliers hardly move. Neither where the prism sits nor how the clocks differ is known; along a
// line some of it cannot be told, so that weak priors hold it: 1 m of lever arm costs as much as
// 20 mm of one residual, 1 s as 10 mm. `body` has z up in its world. Poses and track in order of
// time.
PrismMetrics ComparePrism(std::span<const TumPose> world_from_body,
                          std::span<const PrismPosition> track);

// The keys of evaluation.json: frames, inside, truth_path_m, est_path_m, rms_se2_m, max_se2_m,
// rms_se2_pct (where there is a path), rms_sim2_m, scale_truth_over_est, lever, lever_sim, dt_s,
// dt_sim; or frames, inside and `error`, a sentence.
nlohmann::ordered_json ToJson(const PrismMetrics& metrics);

}  // namespace rigmap
