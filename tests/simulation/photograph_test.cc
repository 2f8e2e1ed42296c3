#include "simulation/photograph.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "simulation/camera_response.h"
#include "simulation/scaled_rig.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

// A drive with something wrong in most frames.
class Photographs : public testing::Test {
 protected:
  static SimulationRequest Request() {
    SimulationRequest request;
    request.contrast = 3.0;
    request.pairs = 12;
    request.rig = Scaled(LocCamRig(), 0.15625);
    request.sand_cell_m = 0.1;
    request.faults = {"lone-left=2:3", "black=3:4",  "truncated=4:5",  "person=5:7",
                      "shadow=8:9",    "glare=9:10", "glare-area=0.3", "dropped=10:11"};
    return request;
  }
  double Difference(const cv::Mat& a, const cv::Mat& b) const {
    return cv::norm(a, b, cv::NORM_L1) / (3.0 * static_cast<double>(a.total()));
  }
  // As the eye's model has it, without anything that happens to a frame.
  cv::Mat Plain(const DriveFrame& frame, Eye eye) const {
    Rigid3 left_from_eye;
    if (eye == Eye::kRight) {
      left_from_eye.rotation = rig_.right_from_left.rotation.conjugate();
      left_from_eye.translation = -(left_from_eye.rotation * rig_.right_from_left.translation);
    }
    const ViewRenderer renderer(world_, rig_.Of(eye).camera);
    return TakePicture(renderer.Render(frame.world_from_left * left_from_eye), {}, {});
  }

  const StereoRig rig_ = Request().rig;
  const DrivePlan plan_ = PlanDrive(Request());
  const World world_{plan_.scene, plan_.path.Outline(0.25)};
  const RoverMotion motion_{plan_.path, [&](double east_m, double north_m) {
                              return world_.terrain().Height(east_m, north_m);
                            }};
  const std::vector<DriveFrame> frames_ = FramesOf(plan_, motion_, MountOf(rig_));
  const Photographer photographer_{world_, rig_, plan_, motion_};
};

TEST_F(Photographs, ShowWhatEachEyeSeesFromItsPosition) {
  for (const Eye eye : kEyes) {
    const Eye other = eye == Eye::kLeft ? Eye::kRight : Eye::kLeft;
    const cv::Mat picture = photographer_.Take(frames_[0], eye);
    const double own = Difference(picture, Plain(frames_[0], eye));
    EXPECT_LT(own, 2.5);  // grey levels: the noise of two pictures
    EXPECT_GT(Difference(picture, Plain(frames_[0], other)), 2.0 * own);
    EXPECT_GT(Difference(picture, Plain(frames_[1], eye)), 2.0 * own);
  }
}

TEST_F(Photographs, FaultsShowWhereTheyAreAskedFor) {
  for (const Eye eye : kEyes) {
    const auto change = [&](int frame) {
      return Difference(photographer_.Take(frames_[frame], eye), Plain(frames_[frame], eye));
    };
    const double noise = change(1);
    for (const int frame : {2, 4, 7, 11}) EXPECT_LT(change(frame), 1.2 * noise) << frame;
    for (const int frame : {3, 5, 6, 8, 9}) EXPECT_GT(change(frame), 1.2 * noise) << frame;
    EXPECT_LT(cv::mean(photographer_.Take(frames_[3], eye))[1], 1.0);
    EXPECT_NEAR(SaturatedShare(photographer_.Take(frames_[9], eye)), 0.3, 0.15);
  }
}

TEST_F(Photographs, FilesHoldThePicturesThatFramesHave) {
  const TemporaryFolder folder;
  for (const DriveFrame& frame : frames_) {
    for (const Eye eye : kEyes) {
      const double saturated = photographer_.Write(frame, eye, folder.Path());
      const auto path = folder.Path() / ImageFileName(frame.stamp_ns, eye);
      ASSERT_EQ(std::filesystem::exists(path), frame.HasImage(eye)) << frame.index;
      if (!frame.HasImage(eye) || frame.fault.truncated == eye) continue;
      const cv::Mat picture = photographer_.Take(frame, eye);
      EXPECT_EQ(cv::norm(cv::imread(path.string()), picture, cv::NORM_INF), 0.0);
      EXPECT_EQ(saturated, SaturatedShare(picture));
    }
  }
}

}  // namespace
}  // namespace rigmap
