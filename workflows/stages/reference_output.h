// The truth and the satellite fixes where the evaluation lays them, in the world of the result, so
// that a report can draw them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluation/trajectory_metrics.h"
#include "georeference/rtk_alignment.h"
#include "scene/trajectory.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {

// reference.json, metres of the world, moved by a rigid motion only:
//   truth  a list of [stamp_ns, x, y, z], true positions of the left camera, laid on the path
//          as the map is laid on the truth (AlignWithTruth): positions and orientations count
//   prism  a list of [stamp_ns, x, y, z], a tracked prism's positions (prism_metrics.h), moved to
//          the left camera; horizontal: z is the camera's own
//   rtk    a list of [stamp_ns, x, y, z], fixes that are RTK_FIXED, moved from the antenna to the
//          left camera; heights are moved alike, so that in the median they are the camera's own
//   rocks  a list of {size, x, y}: as `rocks` or else `surveyed_rocks` of evaluation.json
// Keys of what does not exist are missing. Null where nothing does.
nlohmann::ordered_json DescribeReference(const SurveyedResult& result,
                                         const nlohmann::ordered_json& metrics,
                                         const EvaluationOptions& evaluation,
                                         const RtkAlignmentOptions& alignment);

}  // namespace rigmap
