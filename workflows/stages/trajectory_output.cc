#include "workflows/stages/trajectory_output.h"

#include <fmt/format.h>

#include "dataset/rig_file.h"
#include "export/kitti.h"
#include "export/trajectory_csv.h"
#include "export/tum.h"

namespace rigmap {
namespace {

void WriteText(Publication& publication, const std::string& name, const std::string& text) {
  publication.File(name, [&](std::ostream& stream) { stream << text; });
}

std::string TumOfPoint(const Trajectory& trajectory, const Eigen::Vector3d& x_in_left) {
  return WriteTum(trajectory, {Eigen::Quaterniond::Identity(), x_in_left});
}

}  // namespace

void PublishTrajectory(const StereoRig& rig, const Trajectory& trajectory,
                       Publication& publication) {
  WriteText(publication, "trajectory.csv", WriteTrajectoryCsv(trajectory));
  const Eigen::Vector3d midpoint = 0.5 * rig.right_from_left.Inverse().translation;
  WriteText(publication, "trajectory_midpoint.tum", TumOfPoint(trajectory, midpoint));
  if (rig.antenna_in_left) {
    WriteText(publication, "trajectory_antenna.tum", TumOfPoint(trajectory, *rig.antenna_in_left));
  }
  WriteText(publication, "trajectory_kitti.txt", WriteKitti(trajectory));
  WriteText(publication, "trajectory.tum", WriteTum(trajectory));
}

void PublishRig(const StereoRig& rig, Publication& publication) {
  WriteText(publication, "rig_refined.yaml",
            fmt::format("# The rig of {}, corrected by the images of one part.\n",
                        std::filesystem::path(rig.source).filename().string()) +
                WriteRigFile(rig));
}

}  // namespace rigmap
