#include "tests/mapping/rover_part.h"

#include <fmt/format.h>

namespace rigmap {

RoverPart MakeRoverPart(const SyntheticRoverOptions& options) {
  RoverPart part;
  part.rover = MakeSyntheticRover(options);
  part.correspondences = RoverCorrespondences(part.rover, 4);
  part.odometry = OdometryOfKeyframes(part.rover, part.rover.world_from_left);
  part.dataset.rig = part.rover.rig;
  for (std::size_t i = 0; i < part.rover.frames.size(); ++i) {
    part.dataset.frames.push_back({part.rover.frames[i].stamp_ns, fmt::format("/part/a_{}.PNG", i),
                                   fmt::format("/part/b_{}.png", i)});
  }
  return part;
}

void CutBefore(int frame, Correspondences& correspondences) {
  std::erase_if(correspondences.pairs,
                [&](const FramePair& pair) { return pair.a < frame && pair.b >= frame; });
}

std::vector<Rigid3> KeyframePoses(const KeyframeGraph& graph, const Odometry& odometry) {
  std::vector<Rigid3> poses;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    poses.push_back(odometry[keyframe.frame].world_from_left);
  }
  return poses;
}

}  // namespace rigmap
