#include "imaging/rectifier.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/error.h"
#include "imaging/mask.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

StereoRig IdentityRig() {
  StereoRig rig;
  rig.left.camera = {640, 480, 500.0, 500.0, 318.3, 241.7};
  rig.right = rig.left;
  rig.right_from_left.translation = {-0.2, 0.0, 0.0};
  return rig;
}

// A wide and visibly turned pair, with tangential distortion.
StereoRig TurnedRig() {
  StereoRig rig;
  rig.left.camera = {752,   480,       458.7,      457.3,    367.2,
                     248.4, -0.283408, 0.07395907, 0.000194, 1.76e-5};
  rig.right.camera = {752,   480,        457.6,      456.1,     380.0,
                      255.2, -0.2836837, 0.07451284, -0.000105, -3.556e-5};
  rig.right_from_left = {ExpRotation({-0.0141, 0.02, -0.01}), {-0.11, 0.004, -0.006}};
  return rig;
}

// One field of interlaced video: pixels twice as high as wide.
StereoRig FieldRig() {
  StereoRig rig = IdentityRig();
  for (RigEye* eye : {&rig.left, &rig.right}) {
    eye->camera.height = 240;
    eye->camera.fy = 250.0;
    eye->camera.cy = 120.3;
  }
  rig.right_from_left.rotation = ExpRotation({0.001, 0.0, 0.0});
  return rig;
}

// What no model of a lens describes, as large as a calibration leaves it at most.
StereoRig RigWithFields() {
  StereoRig rig = TurnedRig();
  SeededRandom random;
  for (RigEye* eye : {&rig.left, &rig.right}) {
    PixelField field{{10, 6, 752.0, 480.0}, {}};
    for (int node = 0; node < field.grid.Nodes(); ++node) {
      field.displacements.emplace_back(random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5));
    }
    eye->lens_field = field;
  }
  return rig;
}

// What is displaced where the model expects it: displaced once more it would be there.
std::optional<Eigen::Vector2d> SeenBy(const RigEye& eye, const Eigen::Vector3d& x_in_eye) {
  std::optional<Eigen::Vector2d> pixel = Project(eye.camera, x_in_eye);
  if (pixel && eye.lens_field) *pixel -= eye.lens_field->At(*pixel);
  return pixel;
}

class RectifierOfRig : public testing::TestWithParam<int> {
 protected:
  static StereoRig RigOf(int number) {
    return number == 0   ? IdentityRig()
           : number == 1 ? TurnedRig()
           : number == 2 ? LocCamRig()
           : number == 3 ? RigWithFields()
                         : FieldRig();
  }
  StereoRig rig_ = RigOf(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Rigs, RectifierOfRig, testing::Values(0, 1, 2, 3, 4));

// An image whose values are its pixels' columns (or rows).
cv::Mat Ramp(const Camera& camera, bool columns) {
  cv::Mat ramp(camera.height, camera.width, CV_32FC1);
  for (int row = 0; row < ramp.rows; ++row) {
    for (int column = 0; column < ramp.cols; ++column) {
      ramp.at<float>(row, column) = static_cast<float>(columns ? column : row);
    }
  }
  return ramp;
}

bool WellInside(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() > 1.0 && pixel.y() > 1.0 && pixel.x() < camera.width - 2.0 &&
         pixel.y() < camera.height - 2.0;
}

// A point at a whole disparity from a whole rectified pixel is seen by both eyes just where the
// rectified views say: equal rows, and disparity = f b / z.
TEST_P(RectifierOfRig, ShowsPointsInEqualRowsAtTheirDisparity) {
  constexpr double kTolerancePx = 0.02;  // 1/32 px steps of remap, rounded
  const Rectifier rectifier(rig_);
  const Camera& view = rectifier.RectifiedCamera();
  const cv::Mat left_x = rectifier.RectifyLeft(Ramp(rig_.left.camera, true));
  const cv::Mat left_y = rectifier.RectifyLeft(Ramp(rig_.left.camera, false));
  const cv::Mat right_x = rectifier.RectifyRight(Ramp(rig_.right.camera, true));
  const cv::Mat right_y = rectifier.RectifyRight(Ramp(rig_.right.camera, false));
  SeededRandom random;
  int seen = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int row = static_cast<int>(random.Uniform(0, view.height));
    const int disparity = static_cast<int>(random.Uniform(1, 120));
    const int column = static_cast<int>(random.Uniform(disparity, view.width));
    const double z = view.fx * rectifier.BaselineM() / disparity;
    const Eigen::Vector3d x_in_left =
        rectifier.LeftFromRectified() *
        Eigen::Vector3d(z * (column - view.cx) / view.fx, z * (row - view.cy) / view.fy, z);
    const auto left = SeenBy(rig_.left, x_in_left);
    const auto right = SeenBy(rig_.right, rig_.right_from_left * x_in_left);
    if (!left || !right || !WellInside(rig_.left.camera, *left) ||
        !WellInside(rig_.right.camera, *right)) {
      continue;
    }
    ++seen;
    EXPECT_NEAR(left_x.at<float>(row, column), left->x(), kTolerancePx);
    EXPECT_NEAR(left_y.at<float>(row, column), left->y(), kTolerancePx);
    EXPECT_NEAR(right_x.at<float>(row, column - disparity), right->x(), kTolerancePx);
    EXPECT_NEAR(right_y.at<float>(row, column - disparity), right->y(), kTolerancePx);
  }
  EXPECT_GT(seen, 500);
}

// What the eye's own axes have turned by, its view does not show.
TEST_P(RectifierOfRig, ShowsThroughATurnedRightEyeWhatItWouldStraight) {
  const Rectifier straight(rig_);
  const Eigen::Vector3d turn(0.002, -0.003, 0.004);
  const Rectifier turned = straight.WithRightTurned(turn);
  const Camera& view = straight.RectifiedCamera();
  ASSERT_EQ(turned.RectifiedCamera().width, view.width);
  const cv::Mat columns = Ramp(rig_.right.camera, true), rows = Ramp(rig_.right.camera, false);
  const cv::Mat x = straight.RectifyRight(columns), y = straight.RectifyRight(rows),
                turned_x = turned.RectifyRight(columns), turned_y = turned.RectifyRight(rows);
  EXPECT_EQ(cv::norm(straight.RectifyLeft(columns), turned.RectifyLeft(columns)), 0.0);
  int seen = 0;
  for (int row = 0; row < view.height; row += 7) {
    for (int column = 0; column < view.width; column += 7) {
      Eigen::Vector2d pixel(x.at<float>(row, column), y.at<float>(row, column));
      if (!WellInside(rig_.right.camera, pixel)) continue;
      if (rig_.right.lens_field) pixel += rig_.right.lens_field->At(pixel);
      const auto ray = Undistort(rig_.right.camera, pixel);
      ASSERT_TRUE(ray);
      const auto moved = SeenBy(rig_.right, ExpRotation(turn) * ray->homogeneous());
      if (!moved || !WellInside(rig_.right.camera, *moved)) continue;
      ++seen;
      EXPECT_NEAR(turned_x.at<float>(row, column), moved->x(), 0.05);
      EXPECT_NEAR(turned_y.at<float>(row, column), moved->y(), 0.05);
    }
  }
  EXPECT_GT(seen, 500);
}

TEST_P(RectifierOfRig, HoldsEveryUsablePixelOfTheLeftImage) {
  rig_.left.calibrated_region =
      PixelRegion{10, 20, rig_.left.camera.width - 30, rig_.left.camera.height - 10};
  const Rectifier rectifier(rig_);
  const Camera& view = rectifier.RectifiedCamera();
  EXPECT_LE(view.width, Rectifier::kMaxGrowth * rig_.left.camera.width + 2);
  const double rows_per_row = view.fy / rig_.left.camera.fy;  // of pixels that are not square
  EXPECT_LE(view.height,
            Rectifier::kMaxGrowth * rig_.left.camera.height * std::max(1.0, rows_per_row) + 2);
  const cv::Mat usable = StaticMask(rig_.left);
  for (int row = 0; row < usable.rows; row += 3) {
    for (int column = 0; column < usable.cols; column += 3) {
      if (usable.at<uchar>(row, column) == 0) continue;
      Eigen::Vector2d moved(column, row);
      if (rig_.left.lens_field) moved += rig_.left.lens_field->At(moved);
      const auto normalised = Undistort(rig_.left.camera, moved);
      ASSERT_TRUE(normalised);
      const Eigen::Vector2d turned = Turn(rectifier.LeftFromRectified().conjugate(), *normalised);
      const Eigen::Vector2d pixel(view.fx * turned.x() + view.cx, view.fy * turned.y() + view.cy);
      ASSERT_TRUE(view.Contains(pixel)) << column << " " << row << " -> " << pixel.transpose();
    }
  }
}

TEST_P(RectifierOfRig, TellsWhereAPixelOfTheLeftImageIsShown) {
  const Rectifier rectifier(rig_);
  const cv::Mat columns = rectifier.RectifyLeft(Ramp(rig_.left.camera, true));
  const cv::Mat rows = rectifier.RectifyLeft(Ramp(rig_.left.camera, false));
  const cv::Mat mask = StaticMask(rig_.left);
  int shown = 0;
  for (int row = 20; row < mask.rows - 20; row += 40) {
    for (int column = 20; column < mask.cols - 20; column += 40) {
      if (mask.at<uchar>(row, column) == 0) continue;
      const auto pixel = rectifier.RectifiedLeft({column, row});
      if (!pixel) continue;
      ++shown;
      // Bilinear, as the ramps are between pixels.
      const cv::Mat at_column(1, 1, CV_32FC1, static_cast<float>(pixel->x())),
          at_row(1, 1, CV_32FC1, static_cast<float>(pixel->y()));
      cv::Mat x, y;
      cv::remap(columns, x, at_column, at_row, cv::INTER_LINEAR);
      cv::remap(rows, y, at_column, at_row, cv::INTER_LINEAR);
      EXPECT_NEAR(x.at<float>(0, 0), column, 0.05) << column << " " << row;
      EXPECT_NEAR(y.at<float>(0, 0), row, 0.05) << column << " " << row;
    }
  }
  EXPECT_GT(shown, 50);
}

TEST_P(RectifierOfRig, RectifiesMasksToWhatIsWhollyUsable) {
  const Rectifier rectifier(rig_);
  cv::Mat mask(rig_.left.camera.height, rig_.left.camera.width, CV_8UC1, cv::Scalar(255));
  mask.colRange(0, mask.cols / 2).setTo(0);
  const cv::Mat view_mask = rectifier.RectifyLeftMask(mask);
  const cv::Mat source_x = rectifier.RectifyLeft(Ramp(rig_.left.camera, true));
  EXPECT_GT(cv::countNonZero(view_mask), mask.total() / 3);
  for (int row = 0; row < view_mask.rows; ++row) {
    for (int column = 0; column < view_mask.cols; ++column) {
      if (view_mask.at<uchar>(row, column) == 0) continue;
      ASSERT_GE(source_x.at<float>(row, column), mask.cols / 2 - 0.01F);
    }
  }
}

TEST(Rectifier, DoesNotResampleARectifiedRig) {
  const StereoRig rig = IdentityRig();
  const Rectifier rectifier(rig);
  cv::Mat noise(rig.left.camera.height, rig.left.camera.width, CV_8UC1);
  cv::randu(noise, 0, 256);
  EXPECT_EQ(rectifier.RectifiedCamera().cx, rig.left.camera.cx);
  ASSERT_EQ(rectifier.RectifyLeft(noise).size(), noise.size());
  EXPECT_EQ(cv::norm(rectifier.RectifyLeft(noise), noise, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(rectifier.RectifyRight(noise), noise, cv::NORM_INF), 0.0);
}

// A wide-angle rig whose outermost rays lie far out, or have none where the model folds back.
StereoRig WideRig(double k2) {
  StereoRig rig = IdentityRig();
  for (RigEye* eye : {&rig.left, &rig.right}) {
    eye->camera.fx = eye->camera.fy = 250.0;
    eye->camera.k1 = -0.28;
    eye->camera.k2 = k2;
  }
  return rig;
}

TEST(Rectifier, CutsRaysThatWouldBlowUpTheView) {
  const Camera view = Rectifier(WideRig(0.04)).RectifiedCamera();
  EXPECT_NEAR(view.width, Rectifier::kMaxGrowth * 640, 2);
  EXPECT_LE(view.height, Rectifier::kMaxGrowth * 480 + 2);
}

TEST(Rectifier, EndsWhereTheDistortionFoldsBack) {
  // 1 + 3 k1 r^2 + 5 k2 r^4 = 0 at r = 1.31.
  const Camera view = Rectifier(WideRig(0.03)).RectifiedCamera();
  EXPECT_NEAR(view.width, 2 * 1.31 * 250.0, 10.0);
  EXPECT_NEAR(view.height, 2 * 1.31 * 250.0, 10.0);
}

TEST(Rectifier, RefusesARigThatSeesNothing) {
  StereoRig rig = IdentityRig();
  rig.left.calibrated_region = PixelRegion{2000, 0, 2100, 10};
  EXPECT_THROW(Rectifier{rig}, DataError);
}

}  // namespace
}  // namespace rigmap
