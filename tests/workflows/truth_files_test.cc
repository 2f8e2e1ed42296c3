#include "workflows/truth_files.h"

#include <gmock/gmock.h>

#include <string>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

TEST(TruthOfRunTest, IsOfThePartThatIsNamed) {
  const TemporaryFolder truth;
  for (const char* part : {"Part1", "Part2"}) {
    std::filesystem::create_directories(truth.Path() / part);
    truth.Write(std::string(part) + "/trajectory.tum", "0 0 0 0 0 0 0 1\n");
  }
  EXPECT_EQ(TruthOfRun(truth.Path(), {.part = 2}), truth.Path() / "Part2" / "trajectory.tum");
  EXPECT_EQ(TruthOfRun(truth.Path() / "Part1", {.part = 2}),
            truth.Path() / "Part1" / "trajectory.tum");
  for (const DatasetRequest& request : {DatasetRequest{}, DatasetRequest{.part = 3}}) {
    try {
      TruthOfRun(truth.Path(), request);
      ADD_FAILURE();
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("found Part1, Part2 with one inside"));
    }
  }
}

}  // namespace
}  // namespace rigmap
