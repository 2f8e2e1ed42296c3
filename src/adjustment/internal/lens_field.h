// What a lens does that its model does not describe. Of this room only.
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/pixel_field.h"
#include "scene/rig.h"

namespace rigmap {

// By how much pixels of each eye are to be moved before the lens model holds for them, with ten
// cells along the longer side of the image. Its parameters are x and y (px) of each node, those of
// the left eye first.
class LensField {
 public:
  // All zero.
  explicit LensField(const StereoRig& rig);

  // Of a pixel: the nodes about it (each one's first parameter) and what each counts for.
  struct Support {
    std::array<int, 4> parameter{};
    std::array<double, 4> weight{};
  };
  Support At(Eye eye, const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d Displacement(Eye eye, const Eigen::Vector2d& pixel) const;

  // How the displacement of a pixel follows what the parameters follow, given a row for each.
  template <class Rows>
  Eigen::Matrix<double, 2, Rows::ColsAtCompileTime> Follow(const Support& support,
                                                           const Rows& rows) const {
    Eigen::Matrix<double, 2, Rows::ColsAtCompileTime> sum =
        support.weight[0] * rows.template middleRows<2>(support.parameter[0]);
    for (int i = 1; i < 4; ++i) {
      sum += support.weight[i] * rows.template middleRows<2>(support.parameter[i]);
    }
    return sum;
  }

  int Size() const { return static_cast<int>(values_.size()); }
  const Eigen::VectorXd& Values() const { return values_; }
  // Of the displacement of a node.
  double RmsPx() const;
  void Move(const Eigen::VectorXd& step) { values_ += step; }
  PixelField Of(Eye eye) const;

 private:
  struct EyeGrid : NodeGrid {
    int first = 0;  // parameter
  };
  const EyeGrid& GridOf(Eye eye) const { return grids_[eye == Eye::kLeft ? 0 : 1]; }

  std::array<EyeGrid, 2> grids_;  // of the left eye and the right one
  Eigen::VectorXd values_;
};

}  // namespace rigmap
