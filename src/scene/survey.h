// What satellite receivers tell of a traverse.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "core/stamp.h"

namespace rigmap {

// One position of the rover's antenna, as the receiver wrote it. WGS84.
struct GnssFix {
  StampNs stamp_ns = 0;  // by the receiver's clock
  std::string status;    // RTK_FIXED where the carrier's cycles are counted, else something else
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  Eigen::Vector3d sigma_enu_m = Eigen::Vector3d::Zero();  // as stated; east, north, up
};

inline constexpr std::string_view kRtkFixed = "RTK_FIXED";

enum class RockSize { kSmall = 0, kMedium = 1, kLarge = 2 };

constexpr std::string_view Name(RockSize size) {
  return size == RockSize::kSmall ? "small" : size == RockSize::kMedium ? "medium" : "large";
}

// A rock's place as surveyed, UTM 31N. Which point of the rock it is, is unknown.
struct SurveyedRock {
  RockSize size = RockSize::kSmall;
  double easting_m = 0.0, northing_m = 0.0;
};

}  // namespace rigmap
