#include "report/result_folder.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "tests/report/sample_result.h"
#include "tests/support/message_of.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ResultFolderTest : public testing::Test {
 protected:
  std::string Refusal(const std::string& name) const {
    const std::string said = MessageOf<DataError>([&] { ReadResultFolder(folder_.Path() / name); });
    EXPECT_EQ(said.find('\n'), std::string::npos);
    EXPECT_THAT(said, HasSubstr(name));
    return said;
  }

  TemporaryFolder folder_;
};

TEST_F(ResultFolderTest, IsReadAsFarAsThereIsAnything) {
  const ResultFolder folder = ReadResultFolder(WriteSampleResult(folder_));
  EXPECT_EQ(folder.kind, ResultKind::kPart);
  EXPECT_EQ(folder.trajectory.size(), 4U);
  EXPECT_EQ(folder.trajectory[2].source, PoseSource::kOdometry);
  EXPECT_TRUE(folder.trajectory[2].keyframe);
  EXPECT_NEAR(folder.trajectory[3].world_from_left.translation.x(), 2.0, 1e-12);
  EXPECT_NEAR(folder.trajectory[3].sigmas[0], 3e-4, 1e-12);
  EXPECT_TRUE(folder.evaluation.is_null());
  EXPECT_FALSE(folder.sparse.has_value());
}

TEST_F(ResultFolderTest, WithPartsIsATraverse) {
  const auto root = WriteSampleResult(folder_);
  folder_.Write("result/parts/traverse3-part1/summary.json", SampleSummary("untrusted").dump());
  folder_.Write("result/parts/traverse3-part2/trajectory.tum", "");
  const ResultFolder folder = ReadResultFolder(root);
  EXPECT_EQ(folder.kind, ResultKind::kTraverse);
  ASSERT_EQ(folder.parts.size(), 2U);
  EXPECT_EQ(folder.parts[0].name, "traverse3-part1");
  EXPECT_EQ(folder.parts[0].summary["status"], "untrusted");
  EXPECT_TRUE(folder.parts[1].summary.is_null());
}

TEST_F(ResultFolderTest, WithRowsIsAComparison) {
  folder_.Write("compared/comparison.json", R"({"rows": []})");
  EXPECT_EQ(ReadResultFolder(folder_.Path() / "compared").kind, ResultKind::kComparison);
}

TEST_F(ResultFolderTest, ThatIsNoResultIsRefusedInASentence) {
  EXPECT_THAT(Refusal("nowhere"), HasSubstr("found nothing"));
  folder_.Write("file", "x");
  EXPECT_THAT(Refusal("file"), HasSubstr("found a file"));
  folder_.Write("foreign/thesis.tex", "x");
  EXPECT_THAT(Refusal("foreign"), HasSubstr("neither summary.json nor comparison.json"));
  folder_.Write("half/.dataset", "x");
  EXPECT_THAT(Refusal("half"), HasSubstr("at work there or was killed"));
  folder_.Write("broken/summary.json", "{\"status\": ");
  EXPECT_THAT(Refusal("broken"), AllOf(HasSubstr("summary.json"), HasSubstr("expected JSON")));
  folder_.Write("old/summary.json", R"({"state": "fine"})");
  EXPECT_THAT(Refusal("old"), HasSubstr("as this release of rigmap writes it"));
  folder_.Write("list/summary.json", "[1, 2]");
  EXPECT_THAT(Refusal("list"), HasSubstr("as this release of rigmap writes it"));
  folder_.Write("other/comparison.json", R"({"columns": []})");
  EXPECT_THAT(Refusal("other"), HasSubstr("rows of a comparison"));
}

TEST_F(ResultFolderTest, DamageBesideTheSummaryIsLeftOut) {
  const auto root = WriteSampleResult(folder_);
  folder_.Write("result/trajectory.csv", "stamp_ns\n12,half a pose\n");
  folder_.Write("result/evaluation.json", "{");
  const ResultFolder folder = ReadResultFolder(root);
  EXPECT_TRUE(folder.trajectory.empty());
  EXPECT_TRUE(folder.evaluation.is_null());
  EXPECT_THAT(MessageOf<DataError>([&] { ReadTrajectoryCsv(root / "trajectory.csv"); }),
              HasSubstr("trajectory.csv:2: expected a pose"));
}

}  // namespace
}  // namespace rigmap
