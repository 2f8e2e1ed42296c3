// What happens to a part when its images cannot be read.
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "core/file.h"
#include "export/tum.h"
#include "tests/support/test_file.h"
#include "tests/workflows/faulty_run.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

class SpoiltImage : public FaultTest {
 protected:
  SpoiltImage() { data_ = CopyOfSimulatedPart(folder_.Path()); }

  // Every frame has a pose, that of the spoilt one is a guess between its neighbours' and within 15
  // cm of it (steps are 30 cm), and the summary names the image.
  void ExpectBridged(const std::string& image, std::size_t frame) {
    Succeeds(out_);
    const json summary = SummaryOf(out_);
    EXPECT_EQ(summary["frames"]["paired"], 8);
    EXPECT_EQ(summary["frames"]["posed"], 8);
    const std::vector<std::string> named = summary["health"]["unreadable_images"];
    EXPECT_THAT(named, ElementsAre(EndsWith(image)));
    const auto poses = ReadTum(out_ / "trajectory.tum");
    const auto truth = ReadTum(data_ / "groundtruth_tum.txt");
    ASSERT_EQ(poses.size(), 8U);
    const auto distance_m = [](const std::vector<TumPose>& path, std::size_t a, std::size_t b) {
      return (path[b].world_from_body.translation - path[a].world_from_body.translation).norm();
    };
    EXPECT_NEAR(distance_m(poses, 0, frame), distance_m(truth, 0, frame), 0.15);
    EXPECT_NEAR(distance_m(poses, 0, 7), distance_m(truth, 0, 7), 0.03);
    EXPECT_THAT(ReadTextFile(out_ / "logs" / "features.log"), HasSubstr(image));
  }
};

TEST_F(SpoiltImage, ThatIsTruncatedIsBridged) {
  const fs::path image = data_ / "left" / "0004.png";
  fs::resize_file(image, fs::file_size(image) / 2);
  ExpectBridged("left/0004.png", 4);
}

TEST_F(SpoiltImage, ThatIsEmptyIsBridged) {
  fs::resize_file(data_ / "right" / "0002.png", 0);
  ExpectBridged("right/0002.png", 2);
}

TEST_F(SpoiltImage, ThatIsTextIsBridged) {
  WriteTestFile(data_ / "left" / "0005.png", "no image\n");
  ExpectBridged("left/0005.png", 5);
}

// Its first and last bytes are as they should be.
TEST_F(SpoiltImage, ThatIsDamagedInTheMiddleIsBridged) {
  const fs::path image = data_ / "left" / "0004.png";
  std::fstream file(image, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(fs::file_size(image) / 2));
  file << std::string(2000, '\x55');
  file.close();
  ExpectBridged("left/0004.png", 4);
  Succeeds(out_);  // from what is kept
  EXPECT_EQ(SummaryOf(out_)["health"]["unreadable_images"].size(), 1U);
}

// The world begins at the first frame that shows something: guesses before it have sigmas, and are
// no keyframes that COLMAP could fail to register.
TEST_F(SpoiltImage, AtTheStartIsGuessedFromWhatComesAfter) {
  WriteTestFile(data_ / "left" / "0000.png", "no image\n");
  Succeeds(out_);
  const json summary = SummaryOf(out_);
  EXPECT_EQ(summary["frames"]["posed"], 8);
  EXPECT_EQ(summary["frames"]["registered"], summary["frames"]["keyframes"]);
  const auto poses = ReadTum(out_ / "trajectory.tum");
  const auto truth = ReadTum(data_ / "groundtruth_tum.txt");
  EXPECT_LT(poses[1].world_from_body.translation.norm(), 1e-6);
  EXPECT_NEAR(poses[0].world_from_body.translation.norm(),
              (truth[0].world_from_body.Inverse() * truth[1].world_from_body).translation.norm(),
              0.15);
  std::istringstream rows(ReadTextFile(out_ / "trajectory.csv"));
  std::string heading, first, second;
  std::getline(rows, heading);
  std::getline(rows, first);
  std::getline(rows, second);
  EXPECT_THAT(first, EndsWith("predicted,0"));
  EXPECT_THAT(first, Not(HasSubstr(",0,0,0,0,0,0,")));
  EXPECT_THAT(second, HasSubstr(",0,0,0,0,0,0,adjusted,1"));
}

// Nothing comes after it that would hold a guess.
TEST_F(SpoiltImage, AtTheEndIsPosedByTheOtherEyesImage) {
  WriteTestFile(data_ / "right" / "0007.png", "no image\n");
  Succeeds(out_);
  const std::string rows = ReadTextFile(out_ / "trajectory.csv");
  EXPECT_THAT(rows, EndsWith("odometry,0\n"));
  const auto poses = ReadTum(out_ / "trajectory.tum"),
             truth = ReadTum(data_ / "groundtruth_tum.txt");
  const auto way_m = [](const std::vector<TumPose>& path) {
    return (path[7].world_from_body.translation - path[0].world_from_body.translation).norm();
  };
  EXPECT_NEAR(way_m(poses), way_m(truth), 0.01);
}

// Two of eight is more guessing than is to be trusted.
TEST_F(SpoiltImage, AtBothEndsStillGivesEveryFrameAPose) {
  WriteTestFile(data_ / "left" / "0000.png", "no image\n");
  for (const char* eye : {"left", "right"}) {
    WriteTestFile(data_ / eye / "0007.png", "no image\n");
  }
  const ProgramEnd end = RunRigmap(Arguments(out_));
  EXPECT_EQ(end.exit_code, 3) << end.err;
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("gate predicted is 0.25"));
  EXPECT_EQ(ReadTum(out_ / "trajectory.tum").size(), 8U);
}

TEST_F(SpoiltImage, LeavesNothingToDoWhenAllAreSpoilt) {
  for (int i = 0; i < 8; ++i) {
    WriteTestFile(data_ / "right" / ("000" + std::to_string(i) + ".png"), "no image\n");
  }
  EXPECT_THAT(Fails(out_), HasSubstr("none that can be read"));
  EXPECT_FALSE(fs::exists(out_));
}

// Grey and 16 bit say the same as their grey and 8 bit.
TEST_F(SpoiltImage, IsNoneOfGreyAndSixteenBit) {
  for (const std::string& name : FilesIn(data_)) {
    if (!name.ends_with(".png")) continue;
    const cv::Mat grey = cv::imread(data_ / name, cv::IMREAD_GRAYSCALE);
    ASSERT_TRUE(cv::imwrite(data_ / name, grey));
  }
  Succeeds(undisturbed_);
  for (const std::string& name : FilesIn(data_)) {
    if (!name.ends_with(".png")) continue;
    cv::Mat deep;
    cv::imread(data_ / name, cv::IMREAD_GRAYSCALE).convertTo(deep, CV_16U, 256.0);
    ASSERT_TRUE(cv::imwrite(data_ / name, deep));
  }
  Succeeds(out_);
  EXPECT_TRUE(ResultOf(out_) == ResultOf(undisturbed_));
}

}  // namespace
}  // namespace rigmap
