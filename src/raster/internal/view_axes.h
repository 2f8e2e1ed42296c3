// From where a part is looked at. All views are parallel projections, so that one scale holds
// everywhere across the view.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>

#include "scene/trajectory.h"

namespace rigmap {

// Unit vectors in world, right-handed: right x up = towards_viewer.
struct ViewAxes {
  Eigen::Vector3d right;
  Eigen::Vector3d up;
  Eigen::Vector3d towards_viewer;

  // (along right, along up, along towards_viewer), metres from the world's origin.
  Eigen::Vector3d ViewFromWorld(const Eigen::Vector3d& x_in_world) const {
    return {right.dot(x_in_world), up.dot(x_in_world), towards_viewer.dot(x_in_world)};
  }
};

// The horizontal unit direction in which a path extends most, pointing from its start to its end;
// world's x for one without extent (less than 0.1 m).
Eigen::Vector3d DrivingDirection(const Trajectory& trajectory);

ViewAxes TopView();  // x to the right, y up
// From the right of the path across it: driving goes to the right, z up, nothing foreshortened.
ViewAxes SideView(const Eigen::Vector3d& driving_direction);
// From behind, right of the path and above: 35 degrees down, driving goes to the upper right.
ViewAxes ObliqueView(const Eigen::Vector3d& driving_direction);

// Which values occur, in steps of 5 cm, so that few strays do not count.
class RangeCounter {
 public:
  struct Range {
    double low;
    double high;
  };

  void Add(double value_m);
  // Without at most `share` of the values at either end. At least one value must have been added.
  Range Trimmed(double share) const;

 private:
  std::map<std::int64_t, std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

}  // namespace rigmap
