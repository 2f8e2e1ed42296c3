// How clouds of single frames are made and chained.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in registration_options.cc.

// Of the cloud that one frame shows.
struct CloudOptions {
  static constexpr const char* kSection = "registration";

  double grid_m = 0.0;
  double min_depth_m = 0.0;
  double max_depth_m = 0.0;
  double max_above_m = 0.0;
  double max_below_m = 0.0;
  int denoise_neighbours = 4;
  double denoise_deviations = 1.0;

  OptionFields Fields();
  void RequireRelations() const;  // throws UsageError
};

enum class RegistrationWay { kPlain, kImproved };
constexpr auto NamesOf(RegistrationWay) { return std::array{"plain", "improved"}; }

enum class RegistrationMethod { kPointToPoint, kPointToPlane, kGeneralized };
constexpr auto NamesOf(RegistrationMethod) {
  return std::array{"point-to-point", "point-to-plane", "generalized"};
}

enum class FirstGuess { kNone, kPreviousMotion, kOdometry, kWheels };
constexpr auto NamesOf(FirstGuess) {
  return std::array{"none", "previous-motion", "odometry", "wheels"};
}

// Of cloud against cloud.
struct RegistrationOptions {
  static constexpr const char* kSection = "registration";

  RegistrationWay way = RegistrationWay::kPlain;
  RegistrationMethod method = RegistrationMethod::kPointToPlane;
  FirstGuess first_guess = FirstGuess::kOdometry;
  int map_keyframes = 5;
  double keyframe_overlap = 0.8;
  double max_correspondence_grids = 3.0;
  double kept_share = 0.9;
  double max_normal_angle_deg = 30.0;
  int max_iterations = 50;
  double shared_noise = 3.0;
  double min_overlap = 0.3;

  OptionFields Fields();
};

// Of the clouds to one map.
struct MergeOptions {
  static constexpr const char* kSection = "registration";

  double merge_grid_m = 0.0;

  OptionFields Fields();
};

// What the way asked for means: `plain` sets the options that make it so.
RegistrationOptions Resolved(const RegistrationOptions& options);

}  // namespace rigmap
