// The camera model and the rectification beside OpenCV's own, which were written by others.
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "geometry/rectification.h"
#include "imaging/rectifier.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// A drone's rig: tangential distortion and k3, the right camera turned, raised and set forward.
StereoRig DroneRig() {
  StereoRig rig;
  rig.left.camera = {752,   480,       458.7,      457.3,    367.2,
                     248.4, -0.283408, 0.07395907, 0.000194, 1.76e-5};
  rig.right.camera = {752,   480,        457.6,      456.1,     380.0,
                      255.2, -0.2836837, 0.07451284, -0.000105, -3.556e-5};
  rig.left.camera.k3 = 0.004;
  rig.right.camera.k3 = -0.003;
  rig.right_from_left = {ExpRotation({-0.0141, 0.02, -0.01}), {-0.11, 0.004, -0.006}};
  return rig;
}

cv::Matx33d Intrinsics(const Camera& camera) {
  return {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
}
cv::Vec<double, 5> Distortion(const Camera& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}
cv::Matx33d ToCv(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}
cv::Vec3d ToCv(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }
cv::Vec2d ToCv(const Eigen::Vector2d& x) { return {x.x(), x.y()}; }

struct CvRectification {
  cv::Matx33d r1, r2;  // rectified from left, from right
  cv::Matx34d p1, p2;
  cv::Matx44d q;

  explicit CvRectification(const StereoRig& rig) {
    const cv::Size size(rig.left.camera.width, rig.left.camera.height);
    cv::stereoRectify(Intrinsics(rig.left.camera), Distortion(rig.left.camera),
                      Intrinsics(rig.right.camera), Distortion(rig.right.camera), size,
                      ToCv(rig.right_from_left.rotation), ToCv(rig.right_from_left.translation), r1,
                      r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY);
  }
};

class OpenCvReference : public testing::TestWithParam<bool> {
 protected:
  // A point in left axes that both eyes see, with its pixels.
  struct SeenPoint {
    Eigen::Vector3d x_in_left;
    Eigen::Vector2d left, right;
  };
  std::vector<SeenPoint> SeenPoints() {
    SeededRandom random;
    std::vector<SeenPoint> points;
    while (points.size() < 500) {
      const double depth_m = random.Uniform(0.4, 40.0);
      const Eigen::Vector3d x =
          depth_m * Eigen::Vector3d(random.Uniform(-0.9, 0.9), random.Uniform(-0.6, 0.6), 1.0);
      const auto left = Project(rig_.left.camera, x);
      const auto right = Project(rig_.right.camera, rig_.right_from_left * x);
      if (!left || !right || !rig_.left.camera.Contains(*left)) continue;
      if (rig_.right.camera.Contains(*right)) points.push_back({x, *left, *right});
    }
    return points;
  }
  // OpenCV's pixel of a left or right pixel in the view that is turned by `rotation`.
  static cv::Vec2d Rectified(const Camera& camera, const Eigen::Vector2d& pixel,
                             const cv::Matx33d& rotation, const cv::Matx34d& projection) {
    const cv::TermCriteria exactly(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-13);
    std::vector<cv::Vec2d> turned;
    cv::undistortPoints(std::vector<cv::Vec2d>{ToCv(pixel)}, turned, Intrinsics(camera),
                        Distortion(camera), rotation, projection, exactly);
    return turned.front();
  }

  const StereoRig rig_ = GetParam() ? DroneRig() : LocCamRig();
};

INSTANTIATE_TEST_SUITE_P(Rigs, OpenCvReference, testing::Bool());

TEST_P(OpenCvReference, ProjectsPointsToTheSamePixels) {
  cv::Vec3d turn;
  cv::Rodrigues(ToCv(rig_.right_from_left.rotation), turn);
  for (const SeenPoint& point : SeenPoints()) {
    const std::vector<cv::Vec3d> points{ToCv(point.x_in_left)};
    std::vector<cv::Vec2d> left, right;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), Intrinsics(rig_.left.camera),
                      Distortion(rig_.left.camera), left);
    cv::projectPoints(points, turn, ToCv(rig_.right_from_left.translation),
                      Intrinsics(rig_.right.camera), Distortion(rig_.right.camera), right);
    EXPECT_LT(cv::norm(left.front() - ToCv(point.left)), 1e-6);
    EXPECT_LT(cv::norm(right.front() - ToCv(point.right)), 1e-6);
  }
}

TEST_P(OpenCvReference, UndistortsPixelsToTheSameRays) {
  const Camera& camera = rig_.left.camera;
  const cv::Matx34d back_to_pixels(camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0,
                                   0.0, 0.0, 1.0, 0.0);
  for (const SeenPoint& point : SeenPoints()) {
    const auto ray = Undistort(camera, point.left);
    ASSERT_TRUE(ray);
    const cv::Vec2d ours(camera.fx * ray->x() + camera.cx, camera.fy * ray->y() + camera.cy);
    const cv::Vec2d theirs = Rectified(camera, point.left, cv::Matx33d::eye(), back_to_pixels);
    EXPECT_LT(cv::norm(ours - theirs), 1e-6);
  }
}

// Which way the views face about the baseline is a matter of choice: half of the right camera's
// turn there, the mean viewing direction here. All else is given by the rig.
TEST_P(OpenCvReference, TurnsTheViewsAlikeButAboutTheBaseline) {
  const RectifiedAxes ours = Rectify(rig_.right_from_left);
  const CvRectification theirs(rig_);
  const cv::Matx33d left = ToCv(ours.rectified_from_left) * theirs.r1.t();
  const cv::Matx33d right = ToCv(ours.rectified_from_right) * theirs.r2.t();
  EXPECT_LT(cv::norm(left - right), 1e-9);
  EXPECT_LT(cv::norm(left.row(0) - cv::Matx13d(1.0, 0.0, 0.0)), 1e-9);
  EXPECT_LT(cv::norm(left - cv::Matx33d::eye()), 2e-3);
  EXPECT_NEAR(-theirs.p2(0, 3) / theirs.p2(0, 0), ours.baseline_m, 1e-9);
}

// From one pair of pixels: OpenCV by its views and its matrix of disparity to depth, ours by
// equal rows and f b / disparity.
TEST_P(OpenCvReference, MakesTheSameRowsAndDepthsOfPixels) {
  const CvRectification theirs(rig_);
  const Rectifier rectifier(rig_);
  const Camera& view = rectifier.RectifiedCamera();
  const Eigen::Quaterniond rectified_from_right =
      Rectify(rig_.right_from_left).rectified_from_right;
  for (const SeenPoint& point : SeenPoints()) {
    const cv::Vec2d their_left = Rectified(rig_.left.camera, point.left, theirs.r1, theirs.p1);
    const cv::Vec2d their_right = Rectified(rig_.right.camera, point.right, theirs.r2, theirs.p2);
    EXPECT_NEAR(their_left[1], their_right[1], 1e-6);
    const cv::Vec4d at =
        theirs.q * cv::Vec4d(their_left[0], their_left[1], their_left[0] - their_right[0], 1.0);
    const cv::Vec3d their_x = theirs.r1.t() * (cv::Vec3d(at[0], at[1], at[2]) / at[3]);

    const auto left_ray = Undistort(rig_.left.camera, point.left);
    const auto right_ray = Undistort(rig_.right.camera, point.right);
    ASSERT_TRUE(left_ray && right_ray);
    const Eigen::Vector2d left = Turn(rectifier.LeftFromRectified().conjugate(), *left_ray);
    const Eigen::Vector2d right = Turn(rectified_from_right, *right_ray);
    EXPECT_NEAR(view.fy * left.y(), view.fy * right.y(), 1e-6);
    const double disparity_px = view.fx * (left.x() - right.x());
    const double depth_m = view.fx * rectifier.BaselineM() / disparity_px;
    const Eigen::Vector3d x = rectifier.LeftFromRectified() * (depth_m * left.homogeneous());
    EXPECT_LT(cv::norm(ToCv(x) - their_x), 1e-6 * depth_m);
    EXPECT_LT((x - point.x_in_left).norm(), 1e-6 * depth_m);
  }
}

// Image whose values are its pixels' columns, or rows.
cv::Mat Positions(const Camera& camera, bool columns) {
  cv::Mat positions(camera.height, camera.width, CV_32FC1);
  for (int row = 0; row < positions.rows; ++row) {
    for (int column = 0; column < positions.cols; ++column) {
      positions.at<float>(row, column) = static_cast<float>(columns ? column : row);
    }
  }
  return positions;
}

// A view of positions shows where OpenCV's maps point, as far as that is inside the image.
void ExpectMapped(const Camera& eye, const Eigen::Quaterniond& rectified_from_eye,
                  const Camera& view, const cv::Mat& seen_x, const cv::Mat& seen_y) {
  constexpr double kTolerancePx = 0.02;  // remap rounds to 1/32 px
  cv::Mat x, y;
  cv::initUndistortRectifyMap(Intrinsics(eye), Distortion(eye), ToCv(rectified_from_eye),
                              Intrinsics(view), {view.width, view.height}, CV_32FC1, x, y);
  int compared = 0;
  for (int row = 0; row < view.height; ++row) {
    for (int column = 0; column < view.width; ++column) {
      const Eigen::Vector2d pixel(x.at<float>(row, column), y.at<float>(row, column));
      const bool is_inside = pixel.x() > 1.0 && pixel.y() > 1.0 && pixel.x() < eye.width - 2.0 &&
                             pixel.y() < eye.height - 2.0;
      // Zero also where the model folds back, and the view shows nothing.
      if (!is_inside || seen_x.at<float>(row, column) == 0.0F) continue;
      ++compared;
      ASSERT_NEAR(seen_x.at<float>(row, column), pixel.x(), kTolerancePx) << row << " " << column;
      ASSERT_NEAR(seen_y.at<float>(row, column), pixel.y(), kTolerancePx) << row << " " << column;
    }
  }
  EXPECT_GT(compared, eye.width * eye.height / 2);
}

TEST_P(OpenCvReference, ResamplesBothEyesAsItsMapsDo) {
  const Rectifier rectifier(rig_);
  const RectifiedAxes axes = Rectify(rig_.right_from_left);
  const Camera& view = rectifier.RectifiedCamera();
  ExpectMapped(rig_.left.camera, axes.rectified_from_left, view,
               rectifier.RectifyLeft(Positions(rig_.left.camera, true)),
               rectifier.RectifyLeft(Positions(rig_.left.camera, false)));
  ExpectMapped(rig_.right.camera, axes.rectified_from_right, view,
               rectifier.RectifyRight(Positions(rig_.right.camera, true)),
               rectifier.RectifyRight(Positions(rig_.right.camera, false)));
}

}  // namespace
}  // namespace rigmap
