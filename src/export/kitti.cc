#include "export/kitti.h"

#include <fmt/format.h>

#include <iterator>

namespace rigmap {

std::string WriteKitti(const Trajectory& trajectory) {
  std::string text;
  for (const TimedPose& pose : trajectory) {
    const Eigen::Matrix3d rotation = pose.world_from_left.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      fmt::format_to(std::back_inserter(text), "{:.12f} {:.12f} {:.12f} {:.9f}{}", rotation(row, 0),
                     rotation(row, 1), rotation(row, 2), pose.world_from_left.translation(row),
                     row < 2 ? ' ' : '\n');
    }
  }
  return text;
}

}  // namespace rigmap
