#include "tests/simulation/small_world.h"

#include "tests/support/synthetic_rover.h"

namespace rigmap {

std::vector<Eigen::Vector2d> SmallOutline() {
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i <= 10; ++i) outline.emplace_back(0.2 * i, 0.0);
  return outline;
}

const World& SmallWorld() {
  static const World world = [] {
    SceneOptions scene = MakeScene("rocks", 5);
    scene.sand_cell_m = kSmallCell_m;
    scene.debris_per_m2 = 2.0;
    return World(scene, SmallOutline());
  }();
  return world;
}

std::vector<Rigid3> SmallDrive() {
  std::vector<Rigid3> poses;
  for (int i = 0; i <= 8; ++i) {
    Rigid3 pose = RoverPose(0.25 * i, 0.0, 0.0);
    pose.translation.z() = SmallWorld().terrain().Height(0.25 * i, 0.0) + 1.1;
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace rigmap
