#include "export/trajectory_csv.h"

#include <fmt/format.h>

#include "export/pose_text.h"

namespace rigmap {

std::string WriteTrajectoryCsv(const Trajectory& trajectory) {
  std::string text = "stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source,keyframe\n";
  for (const TimedPose& pose : trajectory) {
    const Vector6d& s = pose.sigmas;
    text += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{}\n", pose.stamp_ns,
                        FormatPose(pose.world_from_left, ','), s(0), s(1), s(2), s(3), s(4), s(5),
                        Name(pose.source), pose.keyframe ? 1 : 0);
  }
  return text;
}

}  // namespace rigmap
