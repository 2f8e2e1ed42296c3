#include "geometry/rectification.h"

namespace rigmap {

RectifiedAxes Rectify(const Rigid3& right_from_left) {
  const Rigid3 left_from_right = right_from_left.Inverse();
  const Eigen::Vector3d x_axis = left_from_right.translation.normalized();
  const Eigen::Vector3d mean_view =
      Eigen::Vector3d::UnitZ() + left_from_right.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d y_axis = mean_view.cross(x_axis).normalized();
  Eigen::Matrix3d rectified_from_left;
  rectified_from_left.row(0) = x_axis;
  rectified_from_left.row(1) = y_axis;
  rectified_from_left.row(2) = x_axis.cross(y_axis);
  RectifiedAxes axes;
  axes.rectified_from_left = Eigen::Quaterniond(rectified_from_left).normalized();
  axes.rectified_from_right = (axes.rectified_from_left * left_from_right.rotation).normalized();
  axes.baseline_m = right_from_left.translation.norm();
  return axes;
}

}  // namespace rigmap
