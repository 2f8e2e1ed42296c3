// A small stereo rover on a small simulated beach: images as its cameras store them, poses and
// surface known.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "scene/rig.h"
#include "simulation/drive.h"
#include "simulation/world.h"

namespace rigmap {

// 320 x 240, 260 px, distorted, 12 cm baseline, the right eye turned by a third of a degree; 1.1 m
// above the ground and looking 36 degrees down, so that all it sees is near enough for its eyes.
StereoRig SmallRoverRig();

// Eight pairs, 30 cm apart, on a gentle arc to the left, or 25 on a circle of 1 m radius that the
// last ones go round again; or the same arc on another beach.
enum class SimulatedWay { kArc, kLoop, kElsewhere };

// Building it takes about half a second of one core, writing a second for eight pairs. Those of the
// same way are equal.
class SimulatedPart {
 public:
  explicit SimulatedPart(SimulatedWay way = SimulatedWay::kArc);

  // Poses are in local east, north, up. All frames are paired.
  const std::vector<DriveFrame>& frames() const { return frames_; }

  // How far (m) a place is above the highest surface there, negative below it.
  double HeightAboveGround(const Eigen::Vector3d& position) const;

  // Writes a whole stereo folder: left/ and right/ (0000.png and so on, in colour), times.txt,
  // calib.yaml and groundtruth_tum.txt. Throws DataError when a file cannot be written.
  void WriteStereoFolder(const std::filesystem::path& folder) const;

 private:
  StereoRig rig_;
  DrivePlan plan_;
  World world_;
  RoverMotion motion_;
  std::vector<DriveFrame> frames_;
};

}  // namespace rigmap
