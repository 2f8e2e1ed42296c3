#include "workflows/disk_space.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TraversePlan PlanOfPairs(int pairs) {
  TraversePlan plan;
  plan.jobs.push_back({.pairs = pairs, .megapixels = 0.2});
  return plan;
}

TEST(RequireDiskTest, TakesAFolderThatIsNotThereYet) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(RequireDisk(PlanOfPairs(1), folder.Path() / "not" / "there"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "not"));
}

TEST(RequireDiskTest, NamesWhatIsMissingBeforeAnythingIsDone) {
  const TemporaryFolder folder;
  EXPECT_THAT(MessageOf<DataError>([&] { RequireDisk(PlanOfPairs(1'000'000'000), folder.Path()); }),
              AllOf(HasSubstr(folder.Path().string() + ": expected 7000000000 MB free on its disk"),
                    HasSubstr("found ")));
}

// A run that is taken up again needs only the rest.
TEST(RequireDiskTest, CountsWhatLiesThereAlready) {
  const TemporaryFolder folder;
  folder.Write("parts/1/points.bin", std::string(5'000'000, 'x'));
  EXPECT_THAT(MessageOf<DataError>([&] { RequireDisk(PlanOfPairs(1'000'000'000), folder.Path()); }),
              HasSubstr("expected 6999999995 MB"));
}

// COLMAP's names of the images are links to the data.
TEST(RequireDiskTest, CountsNoImagesOfTheInput) {
  const TemporaryFolder folder;
  const auto image = folder.Write("data/left/0000.png", std::string(5'000'000, 'x'));
  const auto images = folder.Path() / "out" / "colmap" / "images";
  std::filesystem::create_directories(images);
  std::filesystem::create_symlink(image, images / "0.png");
  EXPECT_THAT(
      MessageOf<DataError>([&] { RequireDisk(PlanOfPairs(1'000'000'000), folder.Path() / "out"); }),
      HasSubstr("expected 7000000000 MB"));
}

}  // namespace
}  // namespace rigmap
