// The recipe of a simulated part: a world, a drive through it, what the sensors make of it, and the
// truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/rig.h"

namespace rigmap {

struct SimulationRequest {
  std::string scene = "beach";    // of kSceneNames
  std::string path = "straight";  // of kPathNames
  int pairs = 40;                 // at least 3, before faults take some away
  double spacing_m = 0.2;         // from pair to pair at full speed
  double interval_s = 1.2;        // from pair to pair, give or take 40 ms
  std::uint64_t seed = 1;
  std::vector<std::string> faults;      // NAME=VALUE, see PlanFaults
  StereoRig rig;                        // as it is
  std::vector<std::string> rig_errors;  // NAME=VALUE, by which data/rig.yaml is off; WithRigErrors
  double contrast = 1.0;                // times the scene's
  double clock_offset_s = 0.35;         // of the satellite receiver against the images
  int traverse = 3, part = 1;           // what the data set's folders are called
  int depth_every = 20;                 // frames from one true depth map to the next
  bool true_surface = true;             // truth/Part<P>/surface.ply, to judge maps by
  double surface_reach_m = 3.6;         // of it, from the path
  int markers = 0;            // discs to check the cameras with, listed in truth/markers.json
  double sand_cell_m = 0.01;  // of the sand's mesh near the path

  // Throws UsageError with a sentence.
  void Validate() const;
};

// Writes `folder`/data in Katwijk's form and `folder`/truth beside it. Equal requests give equal
// bytes, whatever the number of threads (TBB's). Both folders must not exist. Throws UsageError for
// a request that cannot be met, DataError when a file cannot be written.
void SimulatePart(const SimulationRequest& request, const std::filesystem::path& folder);

// Of these files `data/rig.yaml` and `truth/rig.yaml` alone, at once.
void WriteRigFiles(const SimulationRequest& request, const std::filesystem::path& folder);

}  // namespace rigmap
