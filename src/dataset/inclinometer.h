// The inclinometer of Katwijk's imu.txt. A row: stamp, acceleration xyz (m/s^2), angular rate xyz
// (rad/s), inclinometer acceleration xyz (m/s^2), separated by spaces.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

struct InclinometerReading {
  std::vector<InclinometerSample> samples;  // of the frames that have rows near them, in order
  std::vector<std::string> remarks;         // malformed rows, a file without rows near a frame
};

// For each frame the mean of the inclinometer's rows within 0.5 s of its stamp. Rows may stand in
// any order; malformed ones are left out and counted. Without the file both lists are empty.
// `frames` must have increasing stamps. Reads about a million rows per second, memory does not
// grow with the file.
InclinometerReading ReadInclinometer(const std::filesystem::path& imu_path,
                                     std::span<const StereoFrame> frames);

}  // namespace rigmap
