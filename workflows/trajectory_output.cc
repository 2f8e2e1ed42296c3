#include "workflows/trajectory_output.h"

#include <fmt/format.h>

#include "core/file.h"
#include "dataset/rig_file.h"
#include "export/trajectory_csv.h"
#include "export/tum.h"

namespace rigmap {
namespace {

void WriteText(const std::filesystem::path& path, const std::string& text) {
  WriteFileAtomically(path, [&](std::ostream& stream) { stream << text; });
}

std::string TumOfPoint(const Trajectory& trajectory, const Eigen::Vector3d& x_in_left) {
  return WriteTum(MovePoint(trajectory, {Eigen::Quaterniond::Identity(), x_in_left}));
}

}  // namespace

void WriteTrajectoryOutput(const StereoRig& rig, const Trajectory& trajectory,
                           const std::filesystem::path& folder) {
  WriteText(folder / "trajectory.csv", WriteTrajectoryCsv(trajectory));
  const Eigen::Vector3d midpoint = 0.5 * rig.right_from_left.Inverse().translation;
  WriteText(folder / "trajectory_midpoint.tum", TumOfPoint(trajectory, midpoint));
  if (rig.antenna_in_left) {
    WriteText(folder / "trajectory_antenna.tum", TumOfPoint(trajectory, *rig.antenna_in_left));
  }
  WriteText(folder / "trajectory.tum", WriteTum(trajectory));
}

void WriteRigOutput(const StereoRig& rig, const std::filesystem::path& file) {
  WriteText(file, fmt::format("# The rig of {}, corrected by the images of one part.\n",
                              std::filesystem::path(rig.source).filename().string()) +
                      WriteRigFile(rig));
}

}  // namespace rigmap
