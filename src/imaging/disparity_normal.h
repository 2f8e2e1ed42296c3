// Surface normals from disparities.
#pragma once

#include "imaging/depth_map.h"

namespace rigmap {

// Unit normal of the surface at a pixel, rectified axes, towards the camera; zero where fewer than
// kMinNormalPixels known pixels around it belong to the same surface.
//
// On a plane n . x = h, the disparity f b / z is f b / h n . (x/z, y/z, 1): affine in the pixel. A
// plane is fitted by least squares to every second disparity in a window of 9 x 9, those that
// differ from the middle by more than a step of 1.5 px left out.
inline constexpr int kMinNormalPixels = 10;
Eigen::Vector3d NormalInRectified(const DepthMap& map, int row, int column);

// The same of every known pixel, zero of the others: CV_32FC3.
cv::Mat NormalsInRectified(const DepthMap& map);

// Whether what is known within 12 px of a pixel, and that is most of it, lies on one plane. At a
// step of the depth it does not: matching leads from one side to the other over some eight pixels,
// and a plane through both misses a step of 2 px by 0.5 px (root mean square). A plane is taken for
// one up to 0.3 px, twice the noise.
bool LiesOnPlane(const DepthMap& map, int row, int column);

}  // namespace rigmap
