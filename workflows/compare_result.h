// A finished result beside what is known of the truth.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "export/tum.h"
#include "scene/dataset.h"
#include "scene/trajectory.h"
#include "workflows/part_options.h"

namespace rigmap {

// The keys of trajectory_metrics.h; and where `map_ply` exists and the folder of the truth holds a
// true surface (map_truth.h), `map` and `rocks` with those of map_metrics.h and rock_metrics.h.
nlohmann::ordered_json CompareWithTruth(const std::vector<TumPose>& estimate,
                                        const std::filesystem::path& truth_tum,
                                        const std::filesystem::path& map_ply,
                                        const PartOptions& options);

// Text that changes when what CompareWithTruth reads of the truth does.
std::string DescribeTruth(const std::filesystem::path& truth_tum);

// Whether there are satellite fixes, and the rig knows where the antenna is.
bool HasFixes(const Dataset& dataset);

// `rtk`: how the trajectory lies on the satellite fixes, or why it cannot be laid there; and where
// it can and there are surveyed rocks, `surveyed_rocks` (rock_survey.h). Null unless HasFixes.
nlohmann::ordered_json CompareWithSurvey(const Trajectory& trajectory, const Dataset& dataset,
                                         const std::filesystem::path& map_ply,
                                         const PartOptions& options);

// Text that changes when what CompareWithSurvey takes from the dataset does.
std::string DescribeSurvey(const Dataset& dataset);

}  // namespace rigmap
