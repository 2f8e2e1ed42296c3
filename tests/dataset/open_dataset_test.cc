#include "dataset/open_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "core/error.h"
#include "dataset/dataset_content.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// root/Traverse3/Part1 with four pairs and no rig.
class OpenKatwijkTest : public testing::Test {
 protected:
  OpenKatwijkTest() {
    for (const char* stamp : {"36_5", "36_40", "36_300", "36_1000"}) {
      for (const char* eye : {"_0.png", "_1.png"}) {
        WriteImage(part_ / "LocCam" / (std::string("LocCam_2015_11_26_15_23_") + stamp + eye));
      }
    }
  }
  Dataset Open(const std::filesystem::path& from) const { return OpenDataset({.folder = from}); }

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "root";
  std::filesystem::path part_ = root_ / "Traverse3" / "Part1";
  std::string default_rig_ = folder_.Write("config/loccam.yaml", SampleRigText());
};

TEST_F(OpenKatwijkTest, NearestRigAboveThePartApplies) {
  EXPECT_EQ(OpenDataset({.folder = part_, .default_loccam_rig = default_rig_}).rig.source,
            default_rig_);
  for (const char* location :
       {"root/rig.yaml", "root/Traverse3/calib.yaml", "root/Traverse3/Part1/rig.yaml"}) {
    const auto path = folder_.Write(location, SampleRigText());
    EXPECT_EQ(OpenDataset({.folder = part_, .default_loccam_rig = default_rig_}).rig.source, path);
  }
  const auto own = folder_.Write("own.yaml", SampleRigText());
  EXPECT_EQ(OpenDataset({.folder = part_, .rig = own}).rig.source, own);
}

TEST_F(OpenKatwijkTest, RigThreeFoldersAboveThePartDoesNotApply) {
  folder_.Write("rig.yaml", SampleRigText());
  EXPECT_THAT(MessageOf<DataError>([&] { Open(part_); }),
              HasSubstr("expected calib.yaml or rig.yaml, found neither"));
}

TEST_F(OpenKatwijkTest, RootTraverseAndPartGiveTheSameFrames) {
  folder_.Write("root/rig.yaml", SampleRigText());
  FileHashes hashes;
  const auto key = [&](const std::filesystem::path& folder) {
    return HashContent(Open(folder), hashes).Key();
  };
  const std::string expected = key(part_);
  EXPECT_EQ(key(root_), expected);
  EXPECT_EQ(key(root_ / "Traverse3"), expected);
  EXPECT_EQ(key(root_ / "Traverse3" / "." / "Part1" / ""), expected);
}

TEST_F(OpenKatwijkTest, InclinometerComesWithTheFrames) {
  folder_.Write("root/rig.yaml", SampleRigText());
  folder_.Write("root/Traverse3/Part1/imu.txt",
                "2015_11_26_15_23_36_100 1 2 3 0.4 0.5 0.6 0.1 0.2 9.8\ngarbage\n");
  const Dataset dataset = Open(root_);
  ASSERT_EQ(dataset.inclinometer.size(), 3U) << "the last frame is 0.9 s away";
  EXPECT_EQ(dataset.inclinometer[2].acceleration_in_imu, Eigen::Vector3d(0.1, 0.2, 9.8));
  EXPECT_EQ(dataset.health.remarks.size(), 2U);
}

// Gravity stands in the columns of the rates.
TEST_F(OpenKatwijkTest, AnInclinometerWithoutGravityIsNotBelieved) {
  folder_.Write("root/rig.yaml", SampleRigText());
  folder_.Write("root/Traverse3/Part1/imu.txt",
                "2015_11_26_15_23_36_100 1 2 3 0.1 0.2 9.8 4 5 6\n");
  const Dataset dataset = Open(root_);
  EXPECT_THAT(dataset.inclinometer, IsEmpty());
  EXPECT_THAT(dataset.health.remarks, Contains(AllOf(HasSubstr("imu.txt: expected gravity"),
                                                     HasSubstr("The inclinometer is not used"))));
}

TEST_F(OpenKatwijkTest, FrameRangeIsHalfOpen) {
  folder_.Write("root/rig.yaml", SampleRigText());
  const auto all = Open(root_).frames;
  const auto some = OpenDataset({.folder = root_, .frames = {{1, 3}}}).frames;
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0].stamp_ns, all[1].stamp_ns);
  EXPECT_EQ(some[1].stamp_ns, all[2].stamp_ns);
  EXPECT_EQ(OpenDataset({.folder = root_, .frames = {{0, 4}}}).frames.size(), 4U);
}

TEST_F(OpenKatwijkTest, FrameRangeMustLieInside) {
  folder_.Write("root/rig.yaml", SampleRigText());
  for (const auto& range : {std::pair(0, 5), {2, 2}, {3, 1}, {-1, 2}, {4, 5}}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { OpenDataset({.folder = root_, .frames = range}); }),
                AllOf(StartsWith("--frames "), HasSubstr("END <= 4, the number of pairs found")));
  }
}

TEST_F(OpenKatwijkTest, WhatTheWheelsMeasuredIsPartOfTheContent) {
  folder_.Write("root/rig.yaml", SampleRigText());
  FileHashes hashes;
  const auto key_with = [&](const std::string& first_angle) {
    std::string row = "2015_11_26_15_23_36_100 " + first_angle;
    for (int i = 0; i < 32; ++i) row += " 0";
    folder_.Write("root/Traverse3/Part1/odometry.txt", row + "\n");
    return HashContent(Open(root_), hashes).Key();
  };
  const std::string key = key_with("0.5");
  EXPECT_EQ(Open(root_).wheels.samples.size(), 1U);
  EXPECT_EQ(key_with("0.5"), key);
  EXPECT_NE(key_with("0.6"), key);
  EXPECT_THAT(Open(root_).inertial.problem, HasSubstr("imu.txt: expected rows"));
}

TEST_F(OpenKatwijkTest, ImagesMustHaveTheRigsSize) {
  folder_.Write("root/rig.yaml", SampleRigText());
  WriteImage(part_ / "LocCam" / "LocCam_2015_11_26_15_23_36_5_1.png", 16, 24);
  EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }),
              AllOf(HasSubstr("36_5_1.png: expected 32 x 24 pixels as in"), HasSubstr("rig.yaml"),
                    HasSubstr("found 16 x 24")));
}

TEST_F(OpenKatwijkTest, SizeIsThatOfEachPairThatCanBeRead) {
  folder_.Write("root/rig.yaml", SampleRigText());
  folder_.Write("root/Traverse3/Part1/LocCam/LocCam_2015_11_26_15_23_36_5_1.png", "text");
  EXPECT_EQ(Open(root_).frames.size(), 4U);
  for (const char* name : {"36_1000_1.png", "36_40_0.png"}) {
    WriteImage(part_ / "LocCam" / (std::string("LocCam_2015_11_26_15_23_") + name), 16, 24);
    EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }),
                HasSubstr(std::string(name) + ": expected 32 x 24"));
  }
}

// An unreadable image hides no other of the wrong size, nor does a missing one.
TEST_F(OpenKatwijkTest, SizeIsThatOfTheImageBesideAnUnreadableOne) {
  folder_.Write("root/rig.yaml", SampleRigText());
  const std::string stem = "root/Traverse3/Part1/LocCam/LocCam_2015_11_26_15_23_36_40_";
  folder_.Write(stem + "0.png", "text");
  const auto right = folder_.Path() / (stem + "1.png");
  WriteImage(right, 16, 24);
  EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }),
              HasSubstr("36_40_1.png: expected 32 x 24"));
  std::filesystem::remove(folder_.Path() / (stem + "0.png"));
  EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }),
              HasSubstr("36_40_1.png: expected 32 x 24"));
}

TEST_F(OpenKatwijkTest, RocksAreKnownWhereFixesCannotBeRead) {
  folder_.Write("root/rig.yaml", SampleRigText());
  folder_.Write("root/Rock Data/Rock Positions Traverse 3/small-rocks-traverse3.txt",
                "595001 5785001\n");
  folder_.Write("root/Traverse3/Part1/gps-latlong.txt", "no fixes\n");
  const Dataset dataset = Open(part_);
  EXPECT_THAT(dataset.fixes, IsEmpty());
  EXPECT_EQ(dataset.surveyed_landmarks.size(), 1U);
  EXPECT_THAT(dataset.health.remarks,
              Contains(AllOf(HasSubstr("gps-latlong.txt"), HasSubstr("not compared"))));
}

TEST_F(OpenKatwijkTest, OnePairMustBeReadable) {
  folder_.Write("root/rig.yaml", SampleRigText());
  for (const char* name : {"36_5_1", "36_40_0", "36_300_1", "36_1000_0"}) {
    folder_.Write(
        std::string("root/Traverse3/Part1/LocCam/LocCam_2015_11_26_15_23_") + name + ".png",
        "text");
  }
  EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }),
              AllOf(HasSubstr("36_5_0.png"), HasSubstr("none that can be read"),
                    HasSubstr("any of 4 pairs")));
}

TEST_F(OpenKatwijkTest, MasksMustHaveTheRigsSize) {
  folder_.Write("root/rig.yaml", Replaced(SampleRigText(), "  fx: 31", "  mask: m.png\n  fx: 31"));
  WriteImage(root_ / "m.png");
  EXPECT_THAT(Open(root_).rig.right.mask_path, EndsWith("root/m.png"));
  WriteImage(root_ / "m.png", 32, 25);
  EXPECT_THAT(MessageOf<DataError>([&] { Open(root_); }), HasSubstr("m.png: expected 32 x 24"));
  std::filesystem::remove(root_ / "m.png");
  EXPECT_THAT(
      MessageOf<DataError>([&] { Open(root_); }),
      AllOf(HasSubstr("rig.yaml: expected a mask image, found no file"), EndsWith("root/m.png")));
}

TEST_F(OpenKatwijkTest, FoldersThatAreNoneAreRefused) {
  EXPECT_THAT(MessageOf<DataError>([&] { Open(folder_.Path() / "config"); }),
              EndsWith("found neither"));
  EXPECT_THAT(MessageOf<DataError>([&] { Open(folder_.Path()); }), EndsWith("root is one"));
  EXPECT_THAT(MessageOf<DataError>([&] { Open(folder_.Path() / "none"); }),
              HasSubstr("expected a data set folder, found nothing"));
  EXPECT_THAT(MessageOf<DataError>([&] { Open(default_rig_); }), HasSubstr("found a file"));
}

TEST_F(OpenKatwijkTest, FormatMayBeGiven) {
  folder_.Write("root/rig.yaml", SampleRigText());
  EXPECT_EQ(OpenDataset({.folder = root_, .format = "katwijk"}).frames.size(), 4U);
  EXPECT_THROW(OpenDataset({.folder = root_, .format = "stereo"}), DataError);
  EXPECT_THAT(MessageOf<UsageError>([&] { OpenDataset({.folder = root_, .format = "kitty"}); }),
              HasSubstr("found 'kitty'"));
}

class OpenStereoTest : public testing::Test {
 protected:
  OpenStereoTest() {
    for (const char* name : {"left/0.png", "left/1.png", "right/0.png", "right/1.png"}) {
      WriteImage(folder_.Path() / name);
    }
    folder_.Write("times.txt", "1\n2\n");
    folder_.Write("calib.yaml", SampleRigText());
  }
  Dataset Open() const { return OpenDataset({.folder = folder_.Path()}); }
  TemporaryFolder folder_;
};

TEST_F(OpenStereoTest, IsRecognisedWithItsRig) {
  const Dataset dataset = Open();
  EXPECT_EQ(dataset.format, DatasetFormat::kStereoFolder);
  EXPECT_EQ(dataset.frames.size(), 2U);
  EXPECT_EQ(dataset.rig.Baseline(), 0.12);
  EXPECT_THAT(dataset.inclinometer, IsEmpty());
  EXPECT_THAT(dataset.wheels.problem, HasSubstr("neither wheels nor an inertial unit"));
}

TEST_F(OpenStereoTest, NeedsItsOwnRig) {
  std::filesystem::remove(folder_.Path() / "calib.yaml");
  const auto loccam = folder_.Write("config/loccam.yaml", SampleRigText());
  EXPECT_THROW(OpenDataset({.folder = folder_.Path(), .default_loccam_rig = loccam}), DataError);
  folder_.Write("rig.yaml", SampleRigText());
  EXPECT_EQ(Open().frames.size(), 2U);
}

TEST_F(OpenStereoTest, HasNoTraverse) {
  EXPECT_THROW(OpenDataset({.folder = folder_.Path(), .part = 1}), UsageError);
}

TEST_F(OpenStereoTest, KeyChangesWithEveryInputThatMattersAndNoOther) {
  const auto key = [&](const DatasetRequest& request) {
    FileHashes hashes;
    return HashContent(OpenDataset(request), hashes).Key();
  };
  const DatasetRequest request{.folder = folder_.Path()};
  const std::string before = key(request);
  const auto image = folder_.Path() / "right" / "1.png";
  std::filesystem::last_write_time(
      image, std::filesystem::last_write_time(image) + std::chrono::milliseconds(5));
  EXPECT_EQ(key(request), before);
  const TemporaryFolder elsewhere;
  std::filesystem::copy(
      folder_.Path(), elsewhere.Path(),
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(key({.folder = elsewhere.Path()}), before);

  folder_.Write("calib.yaml", Replaced(SampleRigText(), "fx: 30.5", "fx: 30.500001"));
  const std::string with_rig = key(request);
  EXPECT_NE(with_rig, before);
  folder_.Write("times.txt", "1\n2.000000001\n");
  const std::string with_time = key(request);
  EXPECT_NE(with_time, with_rig);
  std::ofstream(image, std::ios::app) << '\0';
  EXPECT_NE(key(request), with_time);
  EXPECT_NE(key({.folder = folder_.Path(), .frames = {{0, 1}}}), key(request));
}

// A dark frame of 16 bit has values as those of a 12 bit sensor.
TEST_F(OpenStereoTest, OneBrightImageMakesAllSixteenBit) {
  const auto bits = [&] {
    std::vector<int> found;
    for (const StereoFrame& frame : Open().frames) found.push_back(frame.sample_bits);
    return found;
  };
  EXPECT_THAT(bits(), testing::Each(16)) << "of 8 bit";
  FileHashes hashes;
  const auto content = [&] { return HashContent(Open(), hashes).frames; };
  for (const char* name : {"left/0.png", "left/1.png", "right/0.png", "right/1.png"}) {
    WriteWideImage(folder_.Path() / name, 4095);
  }
  EXPECT_THAT(bits(), testing::Each(12));
  const auto dark = content();
  WriteWideImage(folder_.Path() / "right/1.png", 65535);
  EXPECT_THAT(bits(), testing::Each(16));
  EXPECT_NE(content()[0], dark[0]) << "what is made of the dark frame has changed with it";
  EXPECT_EQ(OpenDataset({.folder = folder_.Path(), .frames = {{0, 1}}}).frames[0].sample_bits, 16)
      << "of the part, whichever frames are asked for";
}

TEST(SharedDatasetTest, BeachPartsHaveTheirPairsInOrder) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const auto beach = *data / "beach-dev";
  for (const auto& [part, pairs] : {std::pair(1, 35), std::pair(2, 24)}) {
    const Dataset dataset = OpenDataset({.folder = beach, .traverse = 3, .part = part});
    EXPECT_EQ(std::ssize(dataset.frames), pairs);
    EXPECT_EQ(dataset.health.images_read, 2 * pairs);
    EXPECT_THAT(dataset.health.remarks, IsEmpty());
    EXPECT_EQ(std::ssize(dataset.inclinometer), pairs);
    EXPECT_EQ(dataset.rig.source, (beach / "rig.yaml").string());
    for (std::size_t i = 1; i < dataset.frames.size(); ++i) {
      const double step_s =
          1e-9 * static_cast<double>(dataset.frames[i].stamp_ns - dataset.frames[i - 1].stamp_ns);
      EXPECT_GT(step_s, 0.8) << "unpadded milliseconds read as a fraction?";
      EXPECT_LT(step_s, 2.5);
    }
  }
  EXPECT_THROW(OpenDataset({.folder = beach}), UsageError);
}

TEST(SharedDatasetTest, InclinometerPointsUp) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const Dataset dataset = OpenDataset({.folder = *data / "beach-dev", .traverse = 3, .part = 1});
  ASSERT_FALSE(dataset.inclinometer.empty());
  for (const auto& sample : dataset.inclinometer) {
    const Eigen::Vector3d up_in_left =
        dataset.rig.imu_from_left->rotation.conjugate() * sample.acceleration_in_imu.normalized();
    EXPECT_LT(up_in_left.y(), -0.85) << "the camera's y points down, tilted by 18 degrees";
  }
}

TEST(SharedDatasetTest, StereoFoldersAreRead) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  EXPECT_EQ(OpenDataset({.folder = *data / "kitti-turn"}).frames.size(), 51U);
  EXPECT_EQ(OpenDataset({.folder = *data / "devon-pair"}).frames.size(), 2U);
  const Dataset still = OpenDataset({.folder = *data / "euroc-still"});
  EXPECT_EQ(still.frames.size(), 8U);
  EXPECT_THAT(still.truth_path, EndsWith("groundtruth_tum.txt"));
}

}  // namespace
}  // namespace rigmap
