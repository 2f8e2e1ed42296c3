// What is true of a simulated drive, as files to judge by. Coordinates are local east, north, up in
// metres (LocalFrame); stamps are those of the image files, to the millisecond.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/stamp.h"
#include "georeference/local_frame.h"
#include "scene/rig.h"
#include "simulation/boulders.h"
#include "simulation/rover_motion.h"
#include "simulation/scene_options.h"

namespace rigmap {

struct TruthFrame {
  int index = 0;  // on the drive
  StampNs stamp_ns = 0;
  Rigid3 world_from_left;
  double travelled_m = 0.0;
  double glare_area = 0.0;                             // share of the image meant to saturate
  double saturated_left = 0.0, saturated_right = 0.0;  // share of the pixels that do
};

// What holds for the whole drive.
struct TruthSetting {
  StereoRig rig;
  RoverMount mount;
  SceneOptions scene;
  std::string path;                 // name of its shape
  std::vector<std::string> faults;  // NAME=VALUE as asked for
  std::uint64_t seed = 0;
  std::vector<int> unusable_frames;  // indices of pairs of which an image is black or damaged
  double gps_clock_offset_s = 0.0;   // stamp of a fix minus the time at which it was true
};

// Writes into `folder`:
//   trajectory.tum         world_from_left; a comment line first
//   frames.txt             index, stamp as in the image's name, seconds, metres travelled
//   antenna_at_frames.txt  seconds, antenna east north up, its easting and northing in UTM 31N, its
//                          height above the ellipsoid; metres
//   bloom.txt              index, glare_area, saturated_left, saturated_right
//   truth.json             the origin, how things are mounted, where the sun stands, and what was
//                          asked for; name_T_other is name_from_other, row by row
// Throws DataError when a file cannot be written.
void WriteTruthFiles(const std::filesystem::path& folder, std::span<const TruthFrame> frames,
                     const TruthSetting& setting, const LocalFrame& local);

// rocks.json: of each boulder its size, exact position and top, and path_dist, its centre's
// distance from the way (straight lines between the places of `path`). Throws as above.
void WriteTruthRocks(const std::filesystem::path& file, std::span<const Boulder> boulders,
                     std::span<const Eigen::Vector2d> path, const LocalFrame& local);

}  // namespace rigmap
