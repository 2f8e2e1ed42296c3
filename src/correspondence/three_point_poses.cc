#include "correspondence/internal/three_point_poses.h"

#include <opencv2/calib3d.hpp>

namespace rigmap {

std::vector<Rigid3> ThreePointPoses(std::span<const PointSighting> sightings,
                                    const std::array<int, 3>& sample) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (int index : sample) {
    const PointSighting& s = sightings[index];
    points.emplace_back(s.x_in_reference.x(), s.x_in_reference.y(), s.x_in_reference.z());
    pixels.emplace_back(s.left.x(), s.left.y());
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solveP3P(points, pixels, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations,
               cv::SOLVEPNP_AP3P);
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Vec3d r = rotations[i], t = translations[i];
    poses.push_back({ExpRotation({r[0], r[1], r[2]}), {t[0], t[1], t[2]}});
  }
  return poses;
}

}  // namespace rigmap
