// The calibrated stereo rig.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/pixel_field.h"
#include "geometry/rigid3.h"
#include "geometry/serialize.h"
#include "scene/calibration.h"

namespace rigmap {

enum class Eye { kLeft = 0, kRight = 1 };
constexpr std::array<Eye, 2> kEyes{Eye::kLeft, Eye::kRight};

// Inclusive pixel rectangle in which the calibration holds, OpenCV convention.
struct PixelRegion {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(x0, y0, x1, y1);
  }
};

struct RigEye {
  Camera camera;
  std::optional<PixelRegion> calibrated_region;
  std::string mask_path;  // image whose zero pixels are ignored; empty: none
  // What the lens does beside the camera's model, where a part tells it: by how much pixels are to
  // be moved before the model holds for them. In no rig file.
  std::optional<PixelField> lens_field;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(camera, calibrated_region, mask_path, lens_field);
  }
};

// A drive of the rover, in the order of its joints (scene/rover_sensors.h).
struct RoverWheel {
  Eigen::Vector3d contact_in_imu =
      Eigen::Vector3d::Zero();  // where it touches level ground, metres
  std::optional<int> steering;  // its steering joint, if it has one

  template <class Archive>
  void serialize(Archive& archive) {
    archive(contact_in_imu, steering);
  }
};

struct RoverWheels {
  std::optional<double> radius_m;
  std::vector<RoverWheel> wheels;  // one for each drive

  template <class Archive>
  void serialize(Archive& archive) {
    archive(radius_m, wheels);
  }
};

// What a rig file states of its own calibration, each in place of the adjustment's option of what
// is usual: how far off the right eye's rotation, focal lengths, their ratio fy / fx, principal
// points and each term of the distortion (in the corner of the image) may be by themselves, and the
// noise of the board's corners that it was calibrated with. One standard deviation each.
struct RigSigmas {
  std::optional<double> rotation_deg, focal_pct, aspect_pct, principal_point_px, distortion_px,
      board_px;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rotation_deg, focal_pct, aspect_pct, principal_point_px, distortion_px, board_px);
  }
};

// Two cameras fixed to each other. Camera axes: x right, y down, z forward; the rig frame is the
// left camera. Lengths in metres.
struct StereoRig {
  RigEye left, right;
  Rigid3 right_from_left;
  std::optional<Eigen::Vector3d> antenna_in_left;  // GPS antenna, left camera axes
  std::optional<Rigid3> imu_from_left;
  std::optional<RoverWheels> wheels;       // where the file states their geometry
  std::optional<double> baseline_sigma_m;  // of the baseline's length, where the file states it
  // Of a correction of this rig, where the file states it: what the parts that it was calibrated
  // from leave unknown.
  std::optional<CalibrationMatrix> calibration_covariance;
  RigSigmas stated_sigmas;  // where there is no covariance
  std::string source;       // file it was read from, for messages

  double Baseline() const { return right_from_left.translation.norm(); }
  const RigEye& Of(Eye eye) const { return eye == Eye::kLeft ? left : right; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(left, right, right_from_left, antenna_in_left, imu_from_left, wheels, baseline_sigma_m,
            calibration_covariance, stated_sigmas, source);
  }
};

}  // namespace rigmap
