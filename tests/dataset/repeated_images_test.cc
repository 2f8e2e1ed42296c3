// Pairs of which an image is that of the pair before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "core/error.h"
#include "dataset/open_dataset.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The camera hung, or its left eye did.
TEST(RepeatedImages, LeavesOutPairsThatRepeatTheOneBefore) {
  const TemporaryFolder folder;
  folder.Write("calib.yaml", SampleRigText());
  folder.Write("times.txt", "1\n2\n3\n4\n5\n");
  // The number of the pair that each pair shows, left and right.
  const std::array<int, 5> left{0, 1, 1, 1, 4}, right{0, 1, 1, 3, 4};
  for (std::size_t i = 0; i < left.size(); ++i) {
    for (const auto& [eye, shown] : {std::pair("left", left[i]), std::pair("right", right[i])}) {
      const auto path = [&](std::size_t pair) {
        return folder.Path() / eye / (std::to_string(pair) + ".png");
      };
      const auto original = static_cast<std::size_t>(shown);
      if (original == i) {
        WriteImage(path(i));
      } else {
        std::filesystem::copy(path(original), path(i));
      }
    }
  }
  const Dataset dataset = OpenDataset({.folder = folder.Path()});
  std::vector<StampNs> stamps;
  for (const StereoFrame& frame : dataset.frames) stamps.push_back(frame.stamp_ns);
  EXPECT_THAT(stamps, testing::ElementsAre(1'000'000'000, 2'000'000'000, 5'000'000'000));
  EXPECT_THAT(dataset.health.remarks, testing::Contains(AllOf(HasSubstr("left/2.png: of 2 pairs"),
                                                              HasSubstr("byte for byte"))));
}

TEST(RepeatedImages, NamesAnEyeThatIsStuck) {
  const TemporaryFolder folder;
  folder.Write("calib.yaml", SampleRigText());
  folder.Write("times.txt", "1\n2\n3\n4\n");
  for (const char* name : {"0.png", "1.png", "2.png", "3.png"}) {
    WriteImage(folder.Path() / "left" / name);
    WriteImage(folder.Path() / "right" / "0.png");
    if (name[0] == '0') continue;
    std::filesystem::copy(folder.Path() / "right" / "0.png", folder.Path() / "right" / name);
  }
  EXPECT_THAT(MessageOf<DataError>([&] { OpenDataset({.folder = folder.Path()}); }),
              AllOf(HasSubstr("right/1.png: expected"), HasSubstr("found 3 of 4 that repeat")));
}

}  // namespace
}  // namespace rigmap
