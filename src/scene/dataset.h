// What a dataset folder holds: paths and stamps, no pixels.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/stamp.h"
#include "scene/rig.h"
#include "scene/rig_pool.h"
#include "scene/rover_sensors.h"
#include "scene/survey.h"

namespace rigmap {

struct StereoFrame {
  StampNs stamp_ns = 0;
  std::string left_path, right_path;  // absolute
  // Of the values in files of 16 bit, the same for all frames of a part: of 10, 12, 14 and 16 the
  // least that holds all of them.
  int sample_bits = 16;

  const std::string& PathOf(Eye eye) const { return eye == Eye::kLeft ? left_path : right_path; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, left_path, right_path, sample_bits);
  }
};

// An image of which the other eye's is missing.
struct LoneImage {
  StampNs stamp_ns = 0;
  Eye eye = Eye::kLeft;
  std::string path;  // absolute

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, eye, path);
  }
};

// "left/<stamp_ns>.<ext>" or "right/...": the name under which COLMAP knows a frame's image. The
// extension is the file's, in lower case.
std::string ImageName(const StereoFrame& frame, Eye eye);

// Direction of the measured acceleration (up, at rest), in IMU axes, m/s^2.
struct InclinometerSample {
  StampNs stamp_ns = 0;
  Eigen::Vector3d acceleration_in_imu = Eigen::Vector3d::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, acceleration_in_imu);
  }
};

// What was wrong with the input but could be passed over.
struct DatasetHealth {
  int images_read = 0;                         // image files seen, both eyes
  std::vector<std::string> lone_images;        // no partner with the same stamp
  std::vector<std::string> unreadable_images;  // their frames show nothing
  std::vector<std::string> remarks;            // other findings, a sentence each

  template <class Archive>
  void serialize(Archive& archive) {
    archive(images_read, lone_images, unreadable_images, remarks);
  }
};

enum class DatasetFormat { kKatwijk = 0, kStereoFolder = 1 };

constexpr std::string_view Name(DatasetFormat format) {
  return format == DatasetFormat::kKatwijk ? "katwijk" : "stereo";
}

struct Dataset {
  DatasetFormat format = DatasetFormat::kStereoFolder;
  StereoRig rig;
  std::optional<RigPool> rig_pool;               // where the rig's file is of one
  std::vector<StereoFrame> frames;               // strictly increasing stamps
  std::vector<LoneImage> lone_images;            // from the first frame to the last, by time
  std::vector<InclinometerSample> inclinometer;  // about one per frame, averaged around its stamp
  WheelRecord wheels;          // from somewhat before the first frame to after the last
  InertialRecord inertial;     // the same, all rows
  std::string truth_path;      // poses or a prism's track that came with the data; empty: none
  std::vector<GnssFix> fixes;  // of the rover's satellite receiver
  std::vector<SurveyedLandmark> surveyed_landmarks;  // of the whole traverse
  DatasetHealth health;

  // Without the pool, whose rig has been taken already.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(format, rig, frames, lone_images, inclinometer, wheels, inertial, truth_path, fixes,
            surveyed_landmarks, health);
  }
};

}  // namespace rigmap
