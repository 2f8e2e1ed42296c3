// A finished result beside what is known of the truth.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "evaluation/rock_segmentation.h"
#include "evaluation/rock_survey.h"
#include "evaluation/trajectory_metrics.h"
#include "export/tum.h"
#include "georeference/rtk_alignment.h"
#include "scene/dataset.h"
#include "scene/trajectory.h"

namespace rigmap {

// What a result is compared with. No stage before `evaluation` takes it.
struct Truth {
  // A TUM file, a folder of parts (TruthFiles) or a prism's track (prism_metrics.h); empty: none.
  std::string path;
  std::vector<GnssFix> fixes;
  std::vector<SurveyedLandmark> surveyed_rocks;
};

// The files of a truth: the file itself or, of a folder that holds a folder for each part of a
// traverse, the trajectory.tum of each, all in one frame.
std::vector<std::filesystem::path> TruthFiles(const std::filesystem::path& truth);
// The poses in these TUM files in order of time. Throws DataError as ReadTum.
std::vector<TumPose> ReadTruth(const std::filesystem::path& truth);

// Throws DataError, a sentence with file and line, for a truth that cannot be read.
void RequireTruth(const std::filesystem::path& truth_path);

// The keys of trajectory_metrics.h, those of drift in `drift`, of the truth between the first and
// the last estimated pose; and where `map_ply` exists and the folders of the truth hold a true
// surface (map_truth.h), `map` and `rocks` with those of map_metrics.h and rock_metrics.h. Beside
// a prism's track the keys of prism_metrics.h alone.
nlohmann::ordered_json CompareWithTruth(const std::vector<TumPose>& estimate,
                                        const std::filesystem::path& truth_path,
                                        const std::filesystem::path& map_ply,
                                        const EvaluationOptions& options);

// What makes these figures look as if the truth were of another drive: few poses at the same time,
// a path of another length. Empty where nothing does.
std::string DoubtOfTruth(const nlohmann::ordered_json& metrics);
// Says so.
void WarnOfTruth(const nlohmann::ordered_json& metrics, const std::filesystem::path& truth_path);

struct SurveyedResult {
  const Trajectory& trajectory;
  const StereoRig& rig;
  const Truth& truth;
  std::filesystem::path map_ply;
};

struct SurveyOptions {
  const RtkAlignmentOptions& alignment;
  const RockSegmentationOptions& rocks;
  const RockSurveyOptions& survey;
};

// How the trajectory lies on the satellite fixes and how far from them (rtk_metrics.h), or why it
// cannot be laid there. Null where there are no fixes.
nlohmann::ordered_json CompareWithFixes(const Trajectory& trajectory, const StereoRig& rig,
                                        const std::vector<GnssFix>& fixes,
                                        const RtkAlignmentOptions& options);

// `rtk`: as CompareWithFixes; and where it can be laid there and there are surveyed rocks,
// `surveyed_rocks` (rock_survey.h). Null where there are no fixes.
nlohmann::ordered_json CompareWithSurvey(const SurveyedResult& result,
                                         const SurveyOptions& options);

// Text that changes when what these two take of the truth does: the contents of its files.
std::string DescribeTruth(const Truth& truth);

}  // namespace rigmap
