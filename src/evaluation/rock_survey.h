// The rocks of a map beside those of a survey, where no true surface is known.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/options.h"
#include "evaluation/rock_segmentation.h"
#include "georeference/rtk_alignment.h"
#include "scene/rig.h"
#include "scene/survey.h"
#include "scene/trajectory.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in rock_survey.cc.
struct RockSurveyOptions {
  static constexpr const char* kSection = "rocks";

  double small_half_width_m = 0.22;
  double medium_half_width_m = 0.4;
  double large_half_width_m = 0.55;
  double survey_sigma_m = 0.03;
  double max_sigmas = 3.0;
  double max_from_path_m = 3.5;
  double max_view_m = 6.0;

  OptionFields Fields();
  // Of the kinds "small", "medium" and "large"; any other is taken for large.
  double HalfWidth(std::string_view kind) const;
};

struct SurveyRow {
  SurveyedLandmark surveyed;
  Eigen::Vector2d position_in_plane = Eigen::Vector2d::Zero();  // surveyed; east, north, m
  Eigen::Vector2d position_in_world = Eigen::Vector2d::Zero();  // the same in the map, m
  double limit_m = 0.0;                // how far from there a rock was looked for
  std::optional<SegmentedRock> found;  // nothing: not in the map
  // East and north from the surveyed position to the middle of what the map shows, m. Where found.
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();
};

struct RockSurvey {
  std::vector<SurveyRow> rows;  // the surveyed rocks that the map should show
  int found = 0;
  int segmented = 0;  // rocks of the map
  int unknown = 0;    // of these, belonging to no surveyed rock: drift wood, people, ghosts
};

// Where the map's cameras stood. Kept by reference.
struct RoverViews {
  const Trajectory& trajectory;
  const StereoRig& rig;
};

// The surveyed rocks and the plane they are compared in. Kept by reference.
struct AlignedSurvey {
  std::span<const SurveyedLandmark> rocks;
  const RtkAlignment& alignment;
};

// One to one, nearest first, within half a width and the sigmas. All surveyed rocks take part; rows
// are kept for those near the path of which a third is inside both images of two frames. One that
// hides behind another counts as well. Throws UsageError for options out of range, DataError for
// positions on another grid than a UTM zone.
RockSurvey CompareWithSurvey(const RockSegmentation& map, const RoverViews& views,
                             const AlignedSurvey& survey, const RockSurveyOptions& options = {});

// Keys of evaluation.json, lengths in metres: expected, found, segmented, unknown, and `each`:
// size, easting, northing, x, y (of the map's world), found, and where found east, north, distance,
// height, width.
nlohmann::ordered_json ToJson(const RockSurvey& survey);
// clock_offset_s, clock_offset_sigma_s (where determined), heading_deg, rms_residual_m, used,
// rejected and the plane's origin.
nlohmann::ordered_json ToJson(const RtkAlignment& alignment);

// A line per rock and one with the counts, for people.
std::string FormatTable(const RockSurvey& survey);

}  // namespace rigmap
