#include "dataset/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kRoundingTolerance = 1e-12;  // of unit quaternions

void ExpectEqual(const Camera& a, const Camera& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  const auto numbers = [](const Camera& c) {
    return std::array{c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
  };
  EXPECT_EQ(numbers(a), numbers(b));
}

void ExpectEqual(const RigEye& a, const RigEye& b) {
  ExpectEqual(a.camera, b.camera);
  EXPECT_EQ(a.mask_path, b.mask_path);
  ASSERT_EQ(a.calibrated_region.has_value(), b.calibrated_region.has_value());
  if (!a.calibrated_region) return;
  const auto edges = [](const PixelRegion& r) { return std::array{r.x0, r.y0, r.x1, r.y1}; };
  EXPECT_EQ(edges(*a.calibrated_region), edges(*b.calibrated_region));
}

void ExpectEqual(const Rigid3& a, const Rigid3& b) {
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_LT(AngleOf(a.rotation.conjugate() * b.rotation), kRoundingTolerance);
}

class RigFileTest : public testing::Test {
 protected:
  StereoRig Read(const std::string& text) const {
    return ReadRigFile(folder_.Write("rig.yaml", text));
  }
  // The complaint about the sample with `from` replaced by `to`.
  std::string Complaint(const std::string& from, const std::string& to) const {
    const std::string text = from.empty() ? to : Replaced(SampleRigText(), from, to);
    return MessageOf<DataError>([&] { Read(text); });
  }
  // The complaint about the sample with a line added.
  std::string ComplaintAbout(const std::string& line) const {
    return Complaint("", SampleRigText() + line + "\n");
  }
  TemporaryFolder folder_;
};

TEST_F(RigFileTest, ReadsTheSample) {
  const StereoRig rig = Read(SampleRigText());
  EXPECT_EQ(rig.left.camera.width, 32);
  EXPECT_EQ(rig.left.camera.fy, 30.25);
  EXPECT_EQ(rig.left.camera.p2, -0.002);
  EXPECT_TRUE(rig.right.camera.IsPinhole());
  EXPECT_EQ(rig.right_from_left.translation, Eigen::Vector3d(-0.12, 0.0, 0.0));
  EXPECT_EQ(rig.Baseline(), 0.12);
  EXPECT_FALSE(rig.antenna_in_left || rig.imu_from_left || rig.left.calibrated_region);
  EXPECT_EQ(rig.source, (folder_.Path() / "rig.yaml").string());
}

TEST_F(RigFileTest, ABaselineThatIsNotInMetresIsQuestioned) {
  for (const char* t : {"-120, 0, 0", "-386.1448, 0, 0", "-0.00012, 0, 0"}) {
    const std::string complaint = Complaint("-0.12, 0, 0", t);
    EXPECT_THAT(complaint, HasSubstr("expected a baseline in metres"));
  }
}

TEST_F(RigFileTest, ALeverThatIsNotInMetresIsQuestioned) {
  EXPECT_THAT(ComplaintAbout("antenna_in_left: [150, -420, 80]"),
              HasSubstr("expected metres, at most 30 m from the left camera, found 453.1 m"));
  EXPECT_THAT(ComplaintAbout("imu_from_left: {R: [1,0,0, 0,1,0, 0,0,1], t: [10, 0, 250]}"),
              HasSubstr("found 250.2 m: are they millimetres?"));
  EXPECT_EQ(Read(SampleRigText() + "antenna_in_left: [10, -20, 15]\n").antenna_in_left,
            Eigen::Vector3d(10, -20, 15));
}

TEST_F(RigFileTest, MayStateHowWellTheBaselineIsKnown) {
  EXPECT_FALSE(Read(SampleRigText()).baseline_sigma_m);
  const StereoRig rig = Read(SampleRigText() + "sigmas: {baseline_m: 0.0002}\n");
  EXPECT_EQ(rig.baseline_sigma_m, 0.0002);
  EXPECT_EQ(Read(WriteRigFile(rig)).baseline_sigma_m, 0.0002);
  EXPECT_THAT(ComplaintAbout("sigmas: {baseline_m: -1}"), HasSubstr("expected a sigma, found -1"));
  EXPECT_THAT(ComplaintAbout("sigmas: {focal: 1}"), HasSubstr("focal"));
}

TEST_F(RigFileTest, MayStateTheCovarianceOfItsCalibration) {
  StereoRig rig = Read(SampleRigText());
  CalibrationMatrix covariance = CalibrationMatrix::Identity();
  for (int i = 0; i < kCalibrationSize; ++i) covariance(i, i) = 1e-6 * (i + 1);
  covariance(0, 18) = covariance(18, 0) = 1e-7;
  rig.calibration_covariance = covariance;
  const std::string text = WriteRigFile(rig);
  ASSERT_TRUE(Read(text).calibration_covariance);
  EXPECT_EQ(*Read(text).calibration_covariance, covariance);
  EXPECT_EQ(WriteRigFile(ParseRigFile(text, "rig")), text);
  EXPECT_THAT(ComplaintAbout("sigmas: {covariance: [1, 2]}"), HasSubstr("190"));
  covariance(0, 18) = covariance(18, 0) = 1.0;
  rig.calibration_covariance = covariance;
  EXPECT_THAT(MessageOf<DataError>([&] { Read(WriteRigFile(rig)); }),
              HasSubstr("not positive definite"));
}

TEST_F(RigFileTest, MayStateWhereARoversWheelsAre) {
  EXPECT_FALSE(Read(SampleRigText()).wheels);
  const std::string contacts =
      "contacts_in_imu: [-0.6,-0.4,-0.5, -0.6,0.4,-0.5, 0,-0.4,-0.5, 0,0.4,-0.5, "
      "0.6,-0.4,-0.5, 0.6,0.4,-0.5]";
  const StereoRig rig = Read(SampleRigText() + "wheels: {radius_m: 0.12, " + contacts +
                             ", steered_by: [1, 2, 0, 0, 3, 4]}\n");
  ASSERT_TRUE(rig.wheels);
  EXPECT_EQ(rig.wheels->radius_m, 0.12);
  ASSERT_EQ(rig.wheels->wheels.size(), 6U);
  EXPECT_EQ(rig.wheels->wheels[5].contact_in_imu, Eigen::Vector3d(0.6, 0.4, -0.5));
  EXPECT_EQ(rig.wheels->wheels[4].steering, 2);
  EXPECT_FALSE(rig.wheels->wheels[3].steering);
  const std::string text = WriteRigFile(rig);
  EXPECT_EQ(WriteRigFile(Read(text)), text);
  const auto about = [&](const std::string& keys) {
    return ComplaintAbout("wheels: {" + contacts + ", " + keys + "}");
  };
  EXPECT_THAT(about("steered_by: [1, 2, 0, 0, 3, 5]"), HasSubstr("steering joints 1 to 4"));
  EXPECT_THAT(about("steered_by: [1, 2, 0, 0, 3, 4], radius_m: 0"), HasSubstr("above 0"));
  EXPECT_THAT(about("steered_by: [1, 2]"), HasSubstr("6"));
  EXPECT_THAT(about("steered_by: [1, 2, 0, 0, 3, 4], colour: red"), HasSubstr("colour"));
}

TEST_F(RigFileTest, WriteAndReadAreInverse) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-0.02, 0.02);
  const auto vector = [&] {
    return Eigen::Vector3d(number(random), number(random), number(random));
  };
  for (int i = 0; i < 50; ++i) {
    StereoRig rig = Read(SampleRigText());
    rig.left.camera.fx += number(random);
    rig.left.camera.cx += number(random);
    rig.left.camera.k1 = number(random);
    rig.right_from_left = {ExpRotation(vector()), Eigen::Vector3d(-0.12, 0, 0) + vector()};
    if (i % 2 == 0) rig.antenna_in_left = vector();
    if (i % 3 == 0) rig.imu_from_left = Rigid3{ExpRotation(100.0 * vector()), vector()};
    if (i % 5 == 0) rig.right.calibrated_region = PixelRegion{0, 1, 20 + i % 7, 23};
    if (i % 7 == 0) rig.left.mask_path = folder_.Write("a \"mask\".png", "x").string();
    const StereoRig back = Read(WriteRigFile(rig));
    ExpectEqual(back.left, rig.left);
    ExpectEqual(back.right, rig.right);
    ExpectEqual(back.right_from_left, rig.right_from_left);
    EXPECT_EQ(back.antenna_in_left, rig.antenna_in_left);
    ASSERT_EQ(back.imu_from_left.has_value(), rig.imu_from_left.has_value());
    if (rig.imu_from_left) ExpectEqual(*back.imu_from_left, *rig.imu_from_left);
  }
}

TEST_F(RigFileTest, ReadsOptionalKeys) {
  folder_.Write("masks/left.png", "x");
  const StereoRig rig = Read(Replaced(SampleRigText(), "  cy: 11.75\n",
                                      "  cy: 11.75\n  calibrated_region: [2, 3, 32, 20]\n"
                                      "  mask: masks/left.png\n") +
                             "baseline_m: 0.1200004\nrectified: true\n"
                             "antenna_in_left: [1, 2, 3]\n"
                             "imu_from_left: {R: [0,-1,0, 1,0,0, 0,0,1], t: [4, 5, 6]}\n");
  ASSERT_TRUE(rig.left.calibrated_region);
  EXPECT_EQ(rig.left.calibrated_region->x1, 31) << "cut to the image";
  EXPECT_EQ(rig.left.calibrated_region->y1, 20);
  EXPECT_EQ(rig.left.mask_path, (folder_.Path() / "masks" / "left.png").string());
  EXPECT_EQ(rig.antenna_in_left, Eigen::Vector3d(1, 2, 3));
  ASSERT_TRUE(rig.imu_from_left);
  EXPECT_TRUE((*rig.imu_from_left * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(4, 6, 6)));
}

TEST_F(RigFileTest, RotationWithRoundedNumbersIsMadeExact) {
  const StereoRig rig = Read(Replaced(SampleRigText(), "[1, 0, 0, 0, 1, 0, 0, 0, 1]",
                                      "[0.9998, 0.02, 0, -0.02, 0.9998, 0, 0, 0, 1]"));
  EXPECT_NEAR(rig.right_from_left.rotation.norm(), 1.0, kRoundingTolerance);
  EXPECT_NEAR(AngleOf(rig.right_from_left.rotation), 0.02, 1e-5) << "radians";
}

TEST_F(RigFileTest, UnknownKeysAreNamedWithTheirLine) {
  EXPECT_THAT(ComplaintAbout("antena_in_left: [0, 0, 0]"),
              AllOf(HasSubstr("rig.yaml:21: "), HasSubstr("'antena_in_left'")));
  EXPECT_THAT(Complaint("  fx: 30.5", "  f_x: 30.5"),
              AllOf(HasSubstr("rig.yaml:5: "), HasSubstr("'f_x'")));
  EXPECT_THAT(Complaint("  t: [-0.12", "  T: [-0.12"), HasSubstr("rig.yaml:20: unknown key 'T'"));
}

TEST_F(RigFileTest, MissingKeysAreNamed) {
  EXPECT_THAT(Complaint("  fx: 30.5\n", ""), HasSubstr("key 'fx' is missing"));
  EXPECT_THAT(Complaint("  distortion: [-0.1, 0.02, 0.001, -0.002]\n", ""),
              HasSubstr("key 'distortion' is missing"));
  EXPECT_THAT(Complaint("", "left: {model: PINHOLE}\n"), HasSubstr("key 'width' is missing"));
  EXPECT_THAT(Complaint("", "\n"), HasSubstr("key 'left' is missing"));
}

TEST_F(RigFileTest, StatesSigmasOfItsOwn) {
  const StereoRig rig =
      Read(SampleRigText() +
           "sigmas: {focal_pct: 0.1, aspect_pct: 0.03, rotation_deg: 0.02, board_px: 0.2}\n");
  EXPECT_EQ(rig.stated_sigmas.focal_pct, 0.1);
  EXPECT_EQ(rig.stated_sigmas.rotation_deg, 0.02);
  EXPECT_EQ(rig.stated_sigmas.board_px, 0.2);
  EXPECT_FALSE(rig.stated_sigmas.principal_point_px);
  const StereoRig again = Read(WriteRigFile(rig));
  EXPECT_EQ(again.stated_sigmas.focal_pct, 0.1);
  EXPECT_EQ(again.stated_sigmas.aspect_pct, 0.03);
  EXPECT_EQ(again.stated_sigmas.board_px, 0.2);
  EXPECT_FALSE(again.stated_sigmas.distortion_px);
  EXPECT_THAT(ComplaintAbout("sigmas: {distortion_px: 0}"), HasSubstr("a sigma above 0, found 0"));
  EXPECT_THAT(ComplaintAbout("sigmas: {covariance: [1], board_px: 1}"),
              HasSubstr("board_px beside a covariance"));
}

TEST_F(RigFileTest, K3IsOfTheModelFullOpenCv) {
  const std::string full = Replaced(SampleRigText(), "model: OPENCV", "model: FULL_OPENCV");
  const StereoRig eight = Read(Replaced(full, "-0.002]", "-0.002, 0.03, 0, 0, 0]"));
  EXPECT_EQ(eight.left.camera.k3, 0.03);
  EXPECT_EQ(eight.left.camera.p2, -0.002);
  const StereoRig five = Read(Replaced(full, "-0.002]", "-0.002, 0.03]"));
  EXPECT_EQ(five.left.camera.k3, 0.03);
  ExpectEqual(Read(WriteRigFile(eight)).left, eight.left);
  EXPECT_THAT(Complaint("", Replaced(full, "-0.002]", "-0.002, 0.03, 0, 0.1, 0]")),
              AllOf(HasSubstr("rig.yaml:9: "), HasSubstr("k4, k5 and k6 are not supported")));
  EXPECT_THAT(Complaint("", full), HasSubstr("rig.yaml:9: expected a list of 8 numbers"));
  EXPECT_THAT(Complaint("-0.002]", "-0.002, 0]"),
              AllOf(HasSubstr("rig.yaml:9: "), HasSubstr("5 numbers: k3 is of the model FULL_")));
  EXPECT_THAT(Complaint("  fx: 30.5", "  k3: 0.1\n  fx: 30.5"),
              AllOf(HasSubstr("rig.yaml:5: "), HasSubstr("expected k3 in distortion")));
}

TEST_F(RigFileTest, OtherModelsAreRefusedByName) {
  for (const char* model : {"OPENCV_FISHEYE", "KannalaBrandt", "equidistant"}) {
    EXPECT_THAT(Complaint("model: OPENCV", std::string("model: ") + model),
                AllOf(HasSubstr("rig.yaml:2: "), HasSubstr("fisheye model"), HasSubstr(model)));
  }
  EXPECT_THAT(Complaint("model: OPENCV", "model: RADIAL"),
              HasSubstr("expected model PINHOLE, OPENCV or FULL_OPENCV, found 'RADIAL'"));
}

TEST_F(RigFileTest, MaskMustHaveAName) {
  EXPECT_THAT(Complaint("  fx: 31", "  mask: ''\n  fx: 31"),
              HasSubstr("expected a mask image, found ''"));
}

TEST_F(RigFileTest, PinholeMustHaveNoDistortion) {
  EXPECT_THAT(Complaint("model: OPENCV", "model: PINHOLE"),
              HasSubstr("rig.yaml:9: expected no distortion for model PINHOLE, found [-0.1, 0.02, "
                        "0.001, -0.002]"));
  EXPECT_NO_THROW(
      Read(Replaced(SampleRigText(), "  fx: 31", "  distortion: [0, 0, 0, 0]\n  fx: 31")));
}

TEST_F(RigFileTest, CameraMustMakeSense) {
  EXPECT_THAT(Complaint("  fx: 30.5", "  fx: -30.5"),
              HasSubstr("rig.yaml:5: expected a positive focal length, found -30.5"));
  EXPECT_THAT(Complaint("  fy: 30.25", "  fy: 0"), HasSubstr("rig.yaml:6: "));
  // Millimetres, shares of the width, micrometres.
  for (const char* focal : {"  fx: 2.8", "  fx: 0.95", "  fx: 8000"}) {
    EXPECT_THAT(
        Complaint("  fx: 30.5", focal),
        HasSubstr("rig.yaml:5: expected a focal length in pixels, of 3.2 to 3200 for images "
                  "32 pixels wide, found "));
  }
  EXPECT_THAT(Complaint("  fx: 30.5", "  fx: .nan"), HasSubstr("expected a finite number"));
  for (const char* other : {"  fy: 305", "  fy: 10"}) {
    EXPECT_THAT(Complaint("  fy: 30.25", other),
                HasSubstr("rig.yaml:6: expected focal lengths alike, fy within 2.5 times fx either "
                          "way, found fx = 30.5 and fy = "));
  }
  EXPECT_THAT(Complaint("  cx: 15.5", "  cx: 32"),
              HasSubstr("expected the principal point inside the image of 32 x 24 pixels"));
  EXPECT_THAT(Complaint("  cy: 11.75", "  cy: -0.6"), HasSubstr("principal point"));
  EXPECT_THAT(
      Complaint("  width: 32\n  height: 24\n  fx: 30.5", "  width: 0\n  height: 24\n  fx: 1"),
      HasSubstr("rig.yaml:3: expected a positive size, found 0"));
}

TEST_F(RigFileTest, DistortionMustLeaveTheMiddleOfTheImage) {
  const std::string text = SampleRigText();
  const auto start = text.find("distortion: [");
  const std::string distortion = text.substr(start, text.find(']', start) + 1 - start);
  EXPECT_THAT(Complaint(distortion, "distortion: [-30, 0, 0, 0]"),
              HasSubstr("expected a distortion that at least the middle of the image can be freed "
                        "from, found k1 = -30, k2 = 0"));
  EXPECT_NO_THROW(Read(Replaced(text, distortion, "distortion: [-0.4, 0.2, 0.001, -0.001]")));
}

TEST_F(RigFileTest, RotationMustBeOne) {
  const std::string identity = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
  EXPECT_THAT(Complaint(identity, "[1, 0.01, 0, 0, 1, 0, 0, 0, 1]"),
              AllOf(HasSubstr("rig.yaml:19: expected a rotation"), HasSubstr("0.01")));
  EXPECT_THAT(Complaint(identity, "[1, 0, 0, 0, 1, 0, 0, 0, -1]"), HasSubstr("reflection"));
  EXPECT_THAT(Complaint(identity, "[1, 0, 0, 0, 1, 0, 0, 0]"),
              HasSubstr("expected a list of 9 numbers, found a list of 8"));
}

TEST_F(RigFileTest, BaselineMustBeThereAndPointToTheRight) {
  EXPECT_THAT(Complaint("[-0.12, 0, 0]", "[0, 0, 0]"), HasSubstr("expected a baseline above 0 m"));
  EXPECT_THAT(Complaint("[-0.12, 0, 0]", "[0.12, 0, 0]"),
              HasSubstr("expected the right camera to the right of the left one"));
  EXPECT_THAT(ComplaintAbout("baseline_m: 0.120002"),
              AllOf(HasSubstr("rig.yaml:21: expected baseline_m to equal the length of t, "
                              "0.1200000 m"),
                    HasSubstr("found 0.120002")));
}

TEST_F(RigFileTest, RectifiedMustBeTrue) {
  const std::string promise = SampleRigText() + "rectified: true\n";
  const std::string slanted = Replaced(promise, "[-0.12, 0, 0]", "[-0.12, 0.0002, 0]");
  EXPECT_THAT(Complaint("", slanted), HasSubstr("rig.yaml:21: expected R = 1 and t along -x"));
  EXPECT_THAT(Complaint("", Replaced(promise, "[1, 0, 0, 0, 1, 0, 0, 0, 1]",
                                     "[1, 0.002, 0, -0.002, 1, 0, 0, 0, 1]")),
              HasSubstr("R turned by 0.002 rad"));
  EXPECT_NO_THROW(Read(Replaced(slanted, "rectified: true", "rectified: false")));
  EXPECT_NO_THROW(Read(Replaced(promise, "[-0.12, 0, 0]", "[-0.12, 0.0001, 0]")));
}

TEST_F(RigFileTest, RegionMustFit) {
  EXPECT_THAT(Complaint("  fx: 30.5", "  calibrated_region: [20, 0, 10, 23]\n  fx: 30.5"),
              HasSubstr("rig.yaml:5: expected [x0, y0, x1, y1] with x0 < x1"));
  EXPECT_THAT(Complaint("  fx: 30.5", "  calibrated_region: [40, 0, 50, 23]\n  fx: 30.5"),
              HasSubstr("inside the image of 32 x 24"));
}

TEST(LocCamRigTest, IsTheKatwijkRigInOpenCvsConvention) {
  const StereoRig rig = ReadRigFile(std::filesystem::path(RIGMAP_CONFIG) / "rigs" / "loccam.yaml");
  EXPECT_NEAR(rig.left.camera.cx, 496.714642524, 1e-9) << "px: 1 below MATLAB's";
  EXPECT_NEAR(rig.right.camera.cy, 390.4599724722, 1e-9) << "px: 1 below MATLAB's";
  EXPECT_NEAR(rig.Baseline(), 0.1200794, 1e-7) << "m";
  ASSERT_TRUE(rig.antenna_in_left && rig.imu_from_left);
  EXPECT_NEAR(rig.antenna_in_left->norm(), 1.19, 0.01) << "m";
  const Eigen::Vector3d forward = rig.imu_from_left->rotation * Eigen::Vector3d::UnitZ();
  const double down_deg = std::asin(-forward.z()) * 180.0 / std::acos(-1.0);
  EXPECT_NEAR(down_deg, 17.95, 0.01);
  EXPECT_LT(forward.x(), 0.0) << "the IMU's x points backward";
}

TEST(LocCamRigTest, HasTheExtrinsicsOfTheRenderedSet) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const StereoRig rig = ReadRigFile(std::filesystem::path(RIGMAP_CONFIG) / "rigs" / "loccam.yaml");
  const StereoRig rendered = ReadRigFile(*data / "beach-dev" / "rig.yaml");
  const Rigid3 difference = rig.right_from_left.Inverse() * rendered.right_from_left;
  EXPECT_LT(difference.translation.norm(), 1e-8) << "m";
  EXPECT_LT(AngleOf(difference.rotation), 1e-8) << "rad";
  EXPECT_LT(AngleOf(rig.imu_from_left->rotation.conjugate() * rendered.imu_from_left->rotation),
            0.02)
      << "rad";
}

TEST(SharedRigTest, EveryRigOfTheSharedDataIsRead) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  EXPECT_NEAR(ReadRigFile(*data / "kitti-turn" / "calib.yaml").Baseline(), 0.537, 0.001) << "m";
  EXPECT_NEAR(ReadRigFile(*data / "devon-pair" / "calib.yaml").Baseline(), 0.240, 0.001) << "m";
  EXPECT_NEAR(ReadRigFile(*data / "euroc-still" / "calib.yaml").Baseline(), 0.110, 0.001) << "m";
}

}  // namespace
}  // namespace rigmap
