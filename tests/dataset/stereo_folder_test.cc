#include "dataset/internal/stereo_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

class StereoFolderTest : public testing::Test {
 protected:
  StereoFolderTest() {
    for (const char* name : {"000.png", "001.png", "002.png"}) {
      WriteImage(folder_.Path() / "left" / name);
      WriteImage(folder_.Path() / "right" / name);
    }
    folder_.Write("times.txt", "10.5\n11.0\n\n11.5\n");
  }
  Dataset Read() const { return ReadStereoFolder(folder_.Path()); }
  std::string Complaint() const {
    return MessageOf<DataError>([&] { Read(); });
  }
  TemporaryFolder folder_;
};

TEST_F(StereoFolderTest, ReadsFramesInOrder) {
  const Dataset dataset = Read();
  EXPECT_EQ(dataset.format, DatasetFormat::kStereoFolder);
  ASSERT_EQ(dataset.frames.size(), 3U);
  EXPECT_EQ(dataset.frames[1].stamp_ns, 11'000'000'000);
  EXPECT_THAT(dataset.frames[1].left_path, EndsWith("left/001.png"));
  EXPECT_THAT(dataset.frames[1].right_path, EndsWith("right/001.png"));
  EXPECT_EQ(dataset.health.images_read, 6);
  EXPECT_THAT(dataset.health.remarks, IsEmpty());
  EXPECT_THAT(dataset.truth_path, IsEmpty());
}

TEST_F(StereoFolderTest, TimesMayBeWrittenByNumpy) {
  folder_.Write("times.txt", "# seconds\r\n1.05e+01\r\n 1.1e+01\r\n1.15e+01");
  EXPECT_EQ(Read().frames[0].stamp_ns, 10'500'000'000);
  EXPECT_EQ(Read().frames[2].stamp_ns, 11'500'000'000);
}

TEST_F(StereoFolderTest, TruthIsFound) {
  const auto path = folder_.Write("groundtruth_tum.txt", "10.5 0 0 0 0 0 0 1\n");
  EXPECT_EQ(Read().truth_path, path.string());
}

TEST_F(StereoFolderTest, TrackOfAPrismIsTruthWhereThereAreNoPoses) {
  const auto track = folder_.Write("groundtruth_xy.txt", "10.5 0 0\n11.5 0 1\n");
  EXPECT_EQ(Read().truth_path, track.string());
  const auto poses = folder_.Write("groundtruth_tum.txt", "10.5 0 0 0 0 0 0 1\n");
  EXPECT_EQ(Read().truth_path, poses.string());
}

TEST_F(StereoFolderTest, UnevenCountsAreNamed) {
  std::filesystem::remove(folder_.Path() / "right" / "002.png");
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("found 3 and 2; "),
                                 EndsWith("left/002.png has no partner of its name")));
  // Names that differ throughout tell nothing.
  for (const char* name : {"000", "001"}) {
    std::filesystem::rename(folder_.Path() / "right" / (std::string(name) + ".png"),
                            folder_.Path() / "right" / (std::string(name) + "_r.png"));
  }
  EXPECT_THAT(Complaint(), EndsWith("found 3 and 2"));
}

TEST_F(StereoFolderTest, MissingRightIsNamed) {
  std::filesystem::remove_all(folder_.Path() / "right");
  EXPECT_TRUE(IsStereoFolder(folder_.Path()));
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("right/"), HasSubstr("found 3 and 0")));
}

TEST_F(StereoFolderTest, EmptyEyesAreNamed) {
  for (const char* eye : {"left", "right"}) {
    std::filesystem::remove_all(folder_.Path() / eye);
    std::filesystem::create_directories(folder_.Path() / eye);
  }
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("at least one"), HasSubstr("found 0 and 0")));
}

TEST_F(StereoFolderTest, TimesMustFitThePairs) {
  folder_.Write("times.txt", "10.5\n11\n");
  EXPECT_THAT(Complaint(), HasSubstr("times.txt: expected 3 times, one per pair, found 2"));
  std::filesystem::remove(folder_.Path() / "times.txt");
  EXPECT_THAT(Complaint(), HasSubstr("times.txt: cannot read"));
}

TEST_F(StereoFolderTest, TimesMustIncreaseAndTheLineIsNamed) {
  folder_.Write("times.txt", "10.5\n11\n11\n");
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("times.txt:3: expected a time after 11.000000000"),
                                 HasSubstr("found 11")));
  folder_.Write("times.txt", "10.5\n\n9\n12\n");
  EXPECT_THAT(Complaint(), HasSubstr("times.txt:3: "));
}

TEST_F(StereoFolderTest, TimesMustBeNumbersAndTheLineIsNamed) {
  folder_.Write("times.txt", "10.5\neleven\n12\n");
  EXPECT_THAT(Complaint(), HasSubstr("times.txt:2: expected a time in seconds, found 'eleven'"));
  folder_.Write("times.txt", "10.5 7\n11\n12\n");
  EXPECT_THAT(Complaint(), HasSubstr("times.txt:1: "));
}

TEST_F(StereoFolderTest, DamagedImagesAreNamedAndTheirPairsKept) {
  CutEnd(folder_.Path() / "right" / "001.png", 10);
  std::filesystem::resize_file(folder_.Path() / "left" / "002.png", 0);
  folder_.Write("left/000.png", "just text");
  const Dataset dataset = Read();
  EXPECT_EQ(dataset.frames.size(), 3U);
  EXPECT_EQ(dataset.health.images_read, 6);
  EXPECT_THAT(dataset.health.unreadable_images,
              testing::ElementsAre(EndsWith("left/000.png"), EndsWith("left/002.png"),
                                   EndsWith("right/001.png")));
}

TEST_F(StereoFolderTest, PairsOfDifferentNumbersAreRemarkedOn) {
  std::filesystem::rename(folder_.Path() / "right" / "002.png", folder_.Path() / "right/003.png");
  EXPECT_THAT(Read().health.remarks, testing::ElementsAre(HasSubstr("1 of 3 pairs")));
}

TEST_F(StereoFolderTest, TimesThatAreNoSecondsAreRemarkedOn) {
  folder_.Write("times.txt", "10500\n11000\n11500\n");
  EXPECT_THAT(Read().health.remarks,
              testing::ElementsAre(HasSubstr("times.txt: pairs are 500 s apart")));
  folder_.Write("times.txt", "10\n10.0005\n10.001\n");
  EXPECT_THAT(Read().health.remarks, testing::ElementsAre(HasSubstr("0.0005 s apart")));
}

TEST_F(StereoFolderTest, NumbersWithoutZerosBeforeThemAreRefused) {
  for (const char* eye : {"left", "right"}) {
    for (const char* name : {"000.png", "001.png", "002.png"}) {
      std::filesystem::remove(folder_.Path() / eye / name);
    }
    for (const char* name : {"9.png", "10.png", "11.png"}) WriteImage(folder_.Path() / eye / name);
  }
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("left/9.png: expected names"),
                                 HasSubstr("found it behind 11.png; pad the numbers")));
}

// The number that orders them need not be the last, and decimals are not whole numbers.
TEST_F(StereoFolderTest, EveryNumberInANameCounts) {
  const auto name_all = [&](const std::vector<std::string>& names) {
    for (const char* eye : {"left", "right"}) {
      std::filesystem::remove_all(folder_.Path() / eye);
      for (const std::string& name : names) WriteImage(folder_.Path() / eye / name);
    }
  };
  name_all({"9_0.png", "10_0.png", "11_0.png"});
  EXPECT_THAT(Complaint(), HasSubstr("left/9_0.png: expected names"));
  name_all({"9.95.png", "10.05.png", "10.1.png"});
  EXPECT_THAT(Complaint(), HasSubstr("left/9.95.png: expected names"));
  name_all({"12.05.png", "12.1.png", "12.15.png"});
  EXPECT_EQ(Read().frames.size(), 3U);
  name_all({"a1_09.png", "a1_10.png", "b1_2.png"});
  EXPECT_EQ(Read().frames.size(), 3U);
}

TEST_F(StereoFolderTest, NamesMayDifferInLetters) {
  for (const char* name : {"000.png", "001.png", "002.png"}) {
    std::filesystem::rename(folder_.Path() / "right" / name,
                            folder_.Path() / "right" / (std::string("right_") + name));
  }
  EXPECT_THAT(Read().health.remarks, IsEmpty());
}

}  // namespace
}  // namespace rigmap
