// How far a trajectory is from the truth.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/options.h"
#include "export/tum.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in trajectory_metrics.cc.
struct EvaluationOptions {
  static constexpr const char* kSection = "evaluation";

  double max_dt_s = 0.02;
  double segment_m = 0.0;

  OptionFields Fields();
};

// Errors after the alignment that favours the estimate most: ate_se3 by a rigid motion, so that an
// error of scale shows, ate_sim3 by a similarity.
struct AlignedError {
  double ate_se3_m = 0.0;             // RMS distance of matched positions
  std::optional<double> ate_se3_pct;  // of the true path; nothing if that is zero
  // The similarity's factor, truth / estimate: 1 is perfect. Nothing for an estimate all of whose
  // matched positions coincide.
  std::optional<double> scale;
  std::optional<double> ate_sim3_m;  // as `scale`
};

// Heights of the estimate, above the xy plane of its own world, after the rigid alignment.
struct HeightError {
  double rms_m = 0.0;
  double drift_pct = 0.0;  // slope of the line that fits the errors over the true path best
};

// Relative errors: over every stretch of the true path that starts at a matched pose and is
// segment_m long or just over, the motion's error divided by the stretch's length; the mean.
struct RelativeError {
  double segment_m = 0.0;
  double translation_pct = 0.0;
  double rotation_deg_per_m = 0.0;
};

struct TrajectoryMetrics {
  std::size_t frames = 0;               // estimated poses
  std::size_t true_frames = 0;          // true poses
  double coverage = 0.0;                // share of true poses that are matched
  double true_path_m = 0.0;             // over all true poses
  double estimated_path_m = 0.0;        // over all estimated poses
  double extent_m = 0.0;                // largest distance of an estimated position from the first
  std::optional<AlignedError> aligned;  // nothing for fewer than three matched poses
  std::optional<HeightError> height;    // as `aligned`
  std::optional<RelativeError> relative;  // nothing where the path has no such stretch
  std::vector<RelativeError> drift;       // over 5, 10, 25, 50 and 100 m, as far as the path goes
};

// Compares positions and rotations of the same body. Both lists in any order; either may be empty.
TrajectoryMetrics CompareTrajectories(std::span<const TumPose> estimate,
                                      std::span<const TumPose> truth,
                                      const EvaluationOptions& options = {});

// The keys of evaluation.json, rounded as printed: frames, gt_frames, coverage, path_m (true),
// est_path_m, extent_m, then `error` (a sentence) or ate_se3_m, ate_sim3_m, ate_se3_pct, scale,
// scale_error_pct, and where there are relative errors segment_m, rpe_t_pct, rpe_r_deg_per_m.
// A number that does not exist has no key.
nlohmann::ordered_json ToJson(const TrajectoryMetrics& metrics);
// height_rms_m, height_drift_pct, and `segments`, a list of segment_m, rpe_t_pct, rpe_r_deg_per_m.
// Null where nothing matches.
nlohmann::ordered_json DriftToJson(const TrajectoryMetrics& metrics);

}  // namespace rigmap
