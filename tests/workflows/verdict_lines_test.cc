#include "workflows/verdict_lines.h"

#include <gmock/gmock.h>

#include "tests/report/sample_result.h"

namespace rigmap {
namespace {

TEST(VerdictLinesTest, TellWhatTheFirstScreenTells) {
  const TemporaryFolder folder;
  folder.Write("result/summary.json", SampleSummary().dump());
  EXPECT_EQ(VerdictLines(folder.Path() / "result"),
            "rigmap: TRUSTED: metres good to 0.31 %\n"
            "rigmap: path 3.00 m +- 0.31 %, worst position +- 1.7 cm (95 %)\n"
            "rigmap: 4 of 4 frames posed; took 12 s and 370 MB; longest dense with 12 s\n");
}

TEST(VerdictLinesTest, DoNotCallTrustedWhatNothingMeasured) {
  const TemporaryFolder folder;
  auto summary = SampleSummary();
  summary["verdict"]["text"] = "nothing checks the metres";
  summary["verdict"]["scale_95_pct"] = nullptr;
  folder.Write("result/summary.json", summary.dump());
  EXPECT_THAT(VerdictLines(folder.Path() / "result"),
              testing::StartsWith("rigmap: CONSISTENT: nothing checks the metres\n"));
}

TEST(VerdictLinesTest, DoNotTakeTheTimeOfTheJoinForThatOfTheWhole) {
  const TemporaryFolder folder;
  auto summary = SampleSummary();
  summary["parts"] = {{{"name", "1"}}, {{"name", "2"}}};
  folder.Write("result/summary.json", summary.dump());
  EXPECT_THAT(VerdictLines(folder.Path() / "result"),
              testing::HasSubstr("frames posed; joining took 12 s and 370 MB"));
}

TEST(VerdictLinesTest, NameTheReport) {
  const TemporaryFolder folder;
  folder.Write("result/summary.json", SampleSummary().dump());
  const auto report = folder.Write("result/report.html", "");
  EXPECT_THAT(VerdictLines(folder.Path() / "result"),
              testing::EndsWith("rigmap: report: " + report.string() + "\n"));
}

TEST(VerdictLinesTest, OfNothingAreNothing) {
  const TemporaryFolder folder;
  EXPECT_EQ(VerdictLines(folder.Path()), "");
  folder.Write("summary.json", "{");
  EXPECT_EQ(VerdictLines(folder.Path()), "");
}

}  // namespace
}  // namespace rigmap
