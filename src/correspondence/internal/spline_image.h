// Grey values between pixels. Of this room only.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "correspondence/patch_alignment.h"

namespace rigmap {

// The cubic spline through the pixels of an image, of which only a part is worked out (Unser,
// Aldroubi and Eden 1993). Beyond its border the nearest pixel is repeated. Linear interpolation
// blurs between pixels, and cubic convolution has another phase there than at them: windows would
// be drawn aside by 0.1 and 0.018 px.
class SplineImage {
 public:
  explicit SplineImage(const GreyView& image) : image_(image) {}

  // Works out `box` and some pixels around it, unless that has been done.
  void Cover(const Eigen::AlignedBox2d& box);

  // Of a place in a box that was covered last.
  float operator()(const Eigen::Vector2d& x) const;

 private:
  void WorkOut();

  GreyView image_;
  Eigen::AlignedBox2d covered_;
  Eigen::Array2i first_ = Eigen::Array2i::Zero();  // column and row of the first coefficient
  int columns_ = 0, rows_ = 0;
  std::vector<float> coefficients_;  // column by column
};

}  // namespace rigmap
