#include "dataset/internal/katwijk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class KatwijkFramesTest : public testing::Test {
 protected:
  std::filesystem::path Image(const std::string& name) const {
    return folder_.Path() / "LocCam" / ("LocCam_2015_11_26_15_23_" + name);
  }
  void WritePair(const std::string& stamp, const std::string& extension = ".png") const {
    WriteImage(Image(stamp + "_0" + extension));
    WriteImage(Image(stamp + "_1" + extension));
  }
  Dataset Read() const { return ReadKatwijkFrames({folder_.Path(), {}, {}}); }
  // The ends of the left images' names, in order.
  std::vector<std::string> Order(const Dataset& dataset) const {
    std::vector<std::string> stamps;
    for (const auto& frame : dataset.frames) {
      const auto stem = std::filesystem::path(frame.left_path).stem().string();
      stamps.push_back(stem.substr(24, stem.size() - 26));
    }
    return stamps;
  }
  TemporaryFolder folder_;
};

TEST_F(KatwijkFramesTest, SortsByTimeNotByName) {
  for (const char* stamp : {"36_5", "36_40", "36_300", "36_1000", "35_999", "37_1"})
    WritePair(stamp);
  const Dataset dataset = Read();
  EXPECT_EQ(dataset.format, DatasetFormat::kKatwijk);
  EXPECT_THAT(Order(dataset), ElementsAre("35_999", "36_5", "36_40", "36_300", "36_1000", "37_1"));
  EXPECT_EQ(dataset.frames[1].stamp_ns, ParseKatwijkStamp("2015_11_26_15_23_36_5"));
  for (std::size_t i = 1; i < dataset.frames.size(); ++i) {
    EXPECT_LT(dataset.frames[i - 1].stamp_ns, dataset.frames[i].stamp_ns);
  }
  EXPECT_EQ(dataset.health.images_read, 12);
  EXPECT_THAT(dataset.health.remarks, IsEmpty());
}

TEST_F(KatwijkFramesTest, EyesArePairedByStamp) {
  WritePair("36_5", ".jpg");
  WritePair("36_40", ".PNG");
  for (const auto& frame : Read().frames) {
    auto left = std::filesystem::path(frame.left_path).stem().string();
    const auto right = std::filesystem::path(frame.right_path).stem().string();
    EXPECT_EQ(left.back(), '0');
    left.back() = '1';
    EXPECT_EQ(left, right);
  }
}

TEST_F(KatwijkFramesTest, LoneEyesAreCountedAndLeftOut) {
  WritePair("36_5");
  WriteImage(Image("37_5_0.png"));
  WriteImage(Image("38_5_1.png"));
  const Dataset dataset = Read();
  EXPECT_THAT(Order(dataset), ElementsAre("36_5"));
  EXPECT_THAT(dataset.health.lone_images,
              ElementsAre(EndsWith("37_5_0.png"), EndsWith("38_5_1.png")));
  EXPECT_EQ(dataset.health.images_read, 4);
  ASSERT_EQ(dataset.lone_images.size(), 2U);
  EXPECT_EQ(dataset.lone_images[0].eye, Eye::kLeft);
  EXPECT_EQ(dataset.lone_images[1].eye, Eye::kRight);
  EXPECT_THAT(dataset.lone_images[1].path, EndsWith("38_5_1.png"));
  EXPECT_LT(dataset.frames[0].stamp_ns, dataset.lone_images[0].stamp_ns);
}

TEST_F(KatwijkFramesTest, DamagedImagesAreNamedAndTheirPairsKept) {
  for (const char* stamp : {"36_5", "37_5", "38_5", "39_5"}) WritePair(stamp);
  CutEnd(Image("37_5_1.png"), 20);
  std::filesystem::resize_file(Image("38_5_0.png"), 0);
  std::ofstream(Image("39_5_0.png")) << "text";
  const Dataset dataset = Read();
  EXPECT_THAT(Order(dataset), ElementsAre("36_5", "37_5", "38_5", "39_5"));
  EXPECT_THAT(dataset.health.unreadable_images,
              ElementsAre(EndsWith("37_5_1.png"), EndsWith("38_5_0.png"), EndsWith("39_5_0.png")));
  EXPECT_THAT(dataset.health.lone_images, IsEmpty());
}

TEST_F(KatwijkFramesTest, DamagedLoneImageMakesNoPair) {
  WritePair("36_5");
  std::ofstream(Image("37_5_0.png")) << "text";
  const Dataset dataset = Read();
  EXPECT_THAT(Order(dataset), ElementsAre("36_5"));
  EXPECT_THAT(dataset.health.unreadable_images, ElementsAre(EndsWith("37_5_0.png")));
  EXPECT_TRUE(dataset.lone_images.empty());
}

TEST_F(KatwijkFramesTest, OfEqualStampsTheWholePairIsTaken) {
  WritePair("37_0", ".jpg");
  WritePair("37_0", ".png");
  CutEnd(Image("37_0_1.jpg"), 20);
  const Dataset dataset = Read();
  ASSERT_EQ(dataset.frames.size(), 1U);
  EXPECT_THAT(dataset.frames[0].left_path, EndsWith(".png"));
  EXPECT_THAT(dataset.frames[0].right_path, EndsWith(".png"));
}

TEST_F(KatwijkFramesTest, NamesThatCannotBeParsedAreRemarkedOn) {
  WritePair("36_5");
  WriteImage(Image("37_0.png"));
  WriteImage(Image("37_5_2.png"));
  WriteImage(folder_.Path() / "LocCam" / "PanCam_1.png");
  folder_.Write("LocCam/LocCam_list.txt", "x");
  const Dataset dataset = Read();
  EXPECT_EQ(dataset.frames.size(), 1U);
  EXPECT_EQ(dataset.health.images_read, 4);
  EXPECT_THAT(dataset.health.lone_images,
              ElementsAre(EndsWith("37_0.png"), EndsWith("37_5_2.png")));
  EXPECT_THAT(dataset.health.remarks, ElementsAre(HasSubstr("37_0.png"), HasSubstr("37_5_2.png")));
}

TEST_F(KatwijkFramesTest, EqualStampsGiveOneFrameOfEqualNames) {
  WriteImage(Image("36_1000_0.png"));
  WritePair("37_0");
  WritePair("37_0", ".jpg");
  WritePair("38_0");
  const Dataset dataset = Read();
  ASSERT_THAT(Order(dataset), ElementsAre("37_0", "38_0"));
  EXPECT_EQ(std::filesystem::path(dataset.frames[0].left_path).extension(),
            std::filesystem::path(dataset.frames[0].right_path).extension());
  EXPECT_EQ(dataset.health.remarks.size(), 3U);
  EXPECT_THAT(dataset.health.remarks, testing::Each(HasSubstr("same stamp and eye as")));
}

TEST_F(KatwijkFramesTest, NoPairAtAllIsAnErrorWithCounts) {
  WriteImage(Image("36_5_0.png"));
  std::ofstream(Image("37_5_0.png")) << "";
  EXPECT_THAT(MessageOf<DataError>([&] { Read(); }),
              HasSubstr("none among 2 images, 1 of them lone and 1 unreadable"));
}

class KatwijkPartsTest : public testing::Test {
 protected:
  KatwijkPartsTest() {
    for (const char* part : {"Traverse1/Part1", "Traverse1/Part2", "Traverse2/Part10",
                             "Traverse2/Part9", "Traverse2/Part2", "Traverse3/Part4"}) {
      std::filesystem::create_directories(folder_.Path() / part / "LocCam");
    }
    std::filesystem::create_directories(folder_.Path() / "Traverse3" / "Part5" / "PanCam");
    std::filesystem::create_directories(folder_.Path() / "Rock Data");
  }
  std::filesystem::path Select(const std::string& inner, std::optional<int> traverse,
                               std::optional<int> part) const {
    const auto from = inner.empty() ? folder_.Path() : folder_.Path() / inner;
    return SelectKatwijkPart(from, traverse, part).folder.lexically_relative(folder_.Path());
  }
  std::string Refusal(const std::string& inner, std::optional<int> traverse,
                      std::optional<int> part) const {
    return MessageOf<UsageError>([&] { Select(inner, traverse, part); });
  }
  TemporaryFolder folder_;
};

TEST_F(KatwijkPartsTest, NumbersChooseThePart) {
  EXPECT_EQ(Select("", 1, 2), "Traverse1/Part2");
  EXPECT_EQ(Select("", 2, 10), "Traverse2/Part10");
  EXPECT_EQ(Select("Traverse2", {}, 9), "Traverse2/Part9");
  EXPECT_EQ(Select("Traverse2", 2, 9), "Traverse2/Part9");
  EXPECT_EQ(Select("Traverse1/Part1", {}, {}), "Traverse1/Part1");
  EXPECT_EQ(Select("Traverse1/Part1", 1, 1), "Traverse1/Part1");
}

TEST_F(KatwijkPartsTest, NumbersMayBeLeftOutWhereTheOtherTells) {
  EXPECT_EQ(Select("", 3, {}), "Traverse3/Part4");
  EXPECT_EQ(Select("", {}, 9), "Traverse2/Part9");
  EXPECT_EQ(Select("Traverse3", {}, {}), "Traverse3/Part4");
}

TEST_F(KatwijkPartsTest, AmbiguousOrMissingPartsListWhatIsThere) {
  EXPECT_THAT(Refusal("", {}, 2),
              AllOf(HasSubstr("traverse 1 part 2, traverse 2 part 2"), Not(HasSubstr("part 4"))));
  EXPECT_THAT(Refusal("Traverse2", {}, {}),
              HasSubstr("traverse 2 part 2, traverse 2 part 9, traverse 2 part 10"));
  EXPECT_THAT(Refusal("", 3, 5), AllOf(HasSubstr("--traverse 3 --part 5"),
                                       HasSubstr("traverse 3 part 4"), Not(HasSubstr("part 5,"))));
  EXPECT_THAT(Refusal("Traverse1/Part1", {}, 2), HasSubstr("traverse 1 part 1"));
  EXPECT_THAT(Refusal("Traverse1", 2, 1), HasSubstr("--traverse 2 --part 1 fits no part"));
}

TEST_F(KatwijkPartsTest, TraverseLevelMayBeMissing) {
  const TemporaryFolder flat;
  std::filesystem::create_directories(flat.Path() / "Part1" / "LocCam");
  std::filesystem::create_directories(flat.Path() / "Part2" / "LocCam");
  EXPECT_EQ(SelectKatwijkPart(flat.Path(), {}, 2).folder, flat.Path() / "Part2");
  EXPECT_EQ(SelectKatwijkPart(flat.Path(), 3, 2).folder, flat.Path() / "Part2");
}

TEST_F(KatwijkPartsTest, OtherFoldersAreNotKatwijk) {
  EXPECT_TRUE(FindKatwijkParts(folder_.Path() / "Rock Data").empty());
  EXPECT_THROW(SelectKatwijkPart(folder_.Path() / "Rock Data", {}, {}), DataError);
}

}  // namespace
}  // namespace rigmap
