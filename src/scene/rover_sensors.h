// What a rover's wheels and its inertial unit measured, without the particulars of a file.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/stamp.h"
#include "geometry/serialize.h"

namespace rigmap {

// Joints of one moment. Drives: three axles from the front to the rear, left before right, positive
// forwards. Steering: front left, front right, rear left, rear right, positive to the left.
struct WheelSample {
  StampNs stamp_ns = 0;
  std::array<double, 6> drive_angle_rad{};  // turned since some start, without jumps
  std::array<double, 6> drive_rate_radps{};
  std::array<double, 4> steering_rad{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, drive_angle_rad, drive_rate_radps, steering_rad);
  }
};

// In IMU axes.
struct InertialSample {
  StampNs stamp_ns = 0;
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d inclination_mps2 = Eigen::Vector3d::Zero();  // up, at rest: as InclinometerSample

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, angular_rate_radps, inclination_mps2);
  }
};

// Strictly increasing stamps. Where there is a `problem`, a sentence that names the file, the
// samples are not to be used; a part can be done without them unless its technique needs them.
struct WheelRecord {
  std::vector<WheelSample> samples;
  std::string problem;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, problem);
  }
};
struct InertialRecord {
  std::vector<InertialSample> samples;
  std::string problem;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, problem);
  }
};

}  // namespace rigmap
