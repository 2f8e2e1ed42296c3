#include "evaluation/rock_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "georeference/local_frame.h"
#include "georeference/utm_grid.h"

namespace rigmap {
namespace {

constexpr double kBody_m = 0.15;  // half the height of a small rock
constexpr int kMinFrames = 2;     // a place that fewer see is not kept in a map

Eigen::Vector2d PositionInPlane(const GridPosition& position, const LocalFrame& plane) {
  const auto zone = UtmZoneOfEpsg(position.epsg);
  if (!zone) {
    throw DataError(fmt::format("surveyed rocks: expected positions in a UTM zone, found EPSG:{}",
                                position.epsg));
  }
  const Geodetic geodetic =
      FromUtm(*zone, position.easting_m, position.northing_m, plane.origin().altitude_m);
  return plane.ToEnu(geodetic).head<2>();
}

bool IsSeen(const Eigen::Vector3d& x_in_world, const TimedPose& pose, const StereoRig& rig,
            double max_view_m) {
  const Eigen::Vector3d x_in_left = pose.world_from_left.Inverse() * x_in_world;
  if (x_in_left.norm() > max_view_m) return false;
  const auto left = Project(rig.left.camera, x_in_left);
  const auto right = Project(rig.right.camera, rig.right_from_left * x_in_left);
  return left && right && rig.left.camera.Contains(*left) && rig.right.camera.Contains(*right);
}

bool IsInMap(const Eigen::Vector3d& x_in_world, const RoverViews& views, double max_view_m) {
  int frames = 0;
  for (const TimedPose& pose : views.trajectory) {
    frames += IsSeen(x_in_world, pose, views.rig, max_view_m) ? 1 : 0;
  }
  return frames >= kMinFrames;
}

// Points of a rock's inside, around its middle: as many of them are in view as of its surface,
// about, but for what it hides itself.
bool IsBodyInMap(const Eigen::Vector3d& middle, double half_width_m, const RoverViews& views,
                 double max_view_m) {
  constexpr int kPoints = 12, kEnough = kPoints / 3;
  constexpr double kInside = 0.7;
  int seen = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kPoints;
    const Eigen::Vector3d arm(std::cos(angle_rad), std::sin(angle_rad), 0.0);
    seen += IsInMap(middle + kInside * half_width_m * arm, views, max_view_m) ? 1 : 0;
  }
  return seen >= kEnough;
}

bool ShouldShow(const Eigen::Vector2d& x_in_world, const std::string& kind, const RoverViews& views,
                const GroundLevel& ground, const RockSurveyOptions& options) {
  const auto level_m = ground.Near(x_in_world);
  const bool near_path = std::ranges::any_of(views.trajectory, [&](const TimedPose& pose) {
    const Eigen::Vector2d camera = pose.world_from_left.translation.head<2>();
    return (camera - x_in_world).norm() <= options.max_from_path_m;
  });
  if (!level_m || !near_path) return false;
  const Eigen::Vector3d middle(x_in_world.x(), x_in_world.y(), *level_m + kBody_m);
  return IsBodyInMap(middle, options.HalfWidth(kind), views, options.max_view_m);
}

double MatchLimit(const SurveyedLandmark& rock, double alignment_sigma_m,
                  const RockSurveyOptions& options) {
  return options.HalfWidth(rock.kind) +
         options.max_sigmas * std::hypot(alignment_sigma_m, options.survey_sigma_m);
}

struct Candidate {
  std::size_t row = 0, rock = 0;
  double distance_m = 0.0;
};

// Gives each row the nearest rock that no nearer row takes; returns how many rocks found a row.
int Match(const std::vector<SegmentedRock>& rocks, const Rigid2& plane_from_world,
          std::vector<SurveyRow>& rows) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rocks.size(); ++j) {
      const Eigen::Vector2d position = plane_from_world * rocks[j].centre;
      const double distance_m = (position - rows[i].position_in_plane).norm();
      if (distance_m <= rows[i].limit_m) candidates.push_back({i, j, distance_m});
    }
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::distance_m);
  std::vector<bool> taken(rocks.size(), false);
  for (const Candidate& candidate : candidates) {
    SurveyRow& row = rows[candidate.row];
    if (row.found || taken[candidate.rock]) continue;
    taken[candidate.rock] = true;
    row.found = rocks[candidate.rock];
    row.offset_m = plane_from_world * row.found->centre - row.position_in_plane;
  }
  return static_cast<int>(std::ranges::count(taken, true));
}

}  // namespace

OptionFields RockSurveyOptions::Fields() {
  return {
      {"small_half_width_m", &small_half_width_m, "m", MoreThan(0.0),
       "Half width of a small rock: the survey's point and the middle of what the map shows may be "
       "that far apart. Of Katwijk's boulders, to about a tenth."},
      {"medium_half_width_m", &medium_half_width_m, "m", MoreThan(0.0),
       "The same of a medium rock."},
      {"large_half_width_m", &large_half_width_m, "m", MoreThan(0.0), "The same of a large rock."},
      {"survey_sigma_m", &survey_sigma_m, "m", AtLeast(0.0),
       "Sigma of a surveyed position, each axis: a hand-held pole."},
      {"max_sigmas", &max_sigmas, "sigmas", AtLeast(0.0),
       "Sigmas of survey and alignment that are allowed on top of a half width."},
      {"max_from_path_m", &max_from_path_m, "m", MoreThan(0.0),
       "A rock this near the path, and in view from max_view_m, should be in the map."},
      {"max_view_m", &max_view_m, "m", MoreThan(0.0),
       "Largest distance from which a rock counts as in view: beyond, the sigma of a depth exceeds "
       "a voxel several times."},
  };
}

double RockSurveyOptions::HalfWidth(std::string_view kind) const {
  return kind == "small"    ? small_half_width_m
         : kind == "medium" ? medium_half_width_m
                            : large_half_width_m;
}

RockSurvey CompareWithSurvey(const RockSegmentation& map, const RoverViews& views,
                             const AlignedSurvey& survey, const RockSurveyOptions& options) {
  RequireValid(options);
  const RtkAlignment& alignment = survey.alignment;
  const LocalFrame plane(alignment.plane_origin);
  const Rigid2 world_from_plane = alignment.plane_from_world.Inverse();
  std::vector<SurveyRow> rows;
  for (const SurveyedLandmark& rock : survey.rocks) {
    SurveyRow row{.surveyed = rock, .position_in_plane = PositionInPlane(rock.position, plane)};
    row.position_in_world = world_from_plane * row.position_in_plane;
    const double sigma_m = alignment.SigmaAt(row.position_in_world);
    row.limit_m = MatchLimit(rock, sigma_m, options);
    rows.push_back(row);
  }
  RockSurvey result;
  result.segmented = static_cast<int>(map.rocks.size());
  result.unknown = result.segmented - Match(map.rocks, alignment.plane_from_world, rows);
  for (const SurveyRow& row : rows) {
    if (!ShouldShow(row.position_in_world, row.surveyed.kind, views, map.ground, options)) continue;
    result.found += row.found ? 1 : 0;
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace rigmap
