// What satellite receivers tell of a traverse and of what lies beside it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "core/stamp.h"
#include "geometry/serialize.h"

namespace rigmap {

// One position of the rover's antenna, as the receiver wrote it. WGS84.
struct GnssFix {
  StampNs stamp_ns = 0;  // by the receiver's clock
  std::string status;    // RTK_FIXED where the carrier's cycles are counted, else something else
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  Eigen::Vector3d sigma_enu_m = Eigen::Vector3d::Zero();  // as stated; east, north, up

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, status, latitude_deg, longitude_deg, altitude_m, sigma_enu_m);
  }
};

inline constexpr std::string_view kRtkFixed = "RTK_FIXED";

// A position on a map grid that its EPSG number names, such as 32631: UTM zone 31 north on WGS84.
struct GridPosition {
  int epsg = 0;
  double easting_m = 0.0, northing_m = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(epsg, easting_m, northing_m);
  }
};

// A landmark's place as surveyed. Which point of it that is, is unknown.
struct SurveyedLandmark {
  std::string kind;  // as the survey calls it, such as "large"
  GridPosition position;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(kind, position);
  }
};

}  // namespace rigmap
