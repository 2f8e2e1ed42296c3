#include "workflows/comparison.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "workflows/compare.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Comparison : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) const {
    WriteFileAtomically(folder_.Path() / name, [&](std::ostream& stream) { stream << text; });
  }
  void WriteSummary(const std::string& status, const std::string& guessed) const {
    Write("summary.json", R"({"status": ")" + status + R"(", "reason": null,
      "frames": {"paired": 20},
      "stages": [{"name": "a", "seconds": 4.0, "peak_rss_mb": 100.0},
                 {"name": "b", "seconds": 6.0, "peak_rss_mb": 300.0}],
      "verdict": {"text": "good \"enough\"", "scale_95_pct": 0.5, "position_95_m": null,
                  "known": {"guessed": )" +
                              guessed + "}}}");
  }

  TemporaryFolder folder_;
};

TEST_F(Comparison, RowTellsWhatTheRunHasLeft) {
  WriteSummary("untrusted", "[[0, 2], [10, 13]]");
  Write("evaluation.json",
        R"({"ate_se3_pct": 0.25, "drift": {"segments": [{"segment_m": 5.0, "rpe_t_pct": 0.75}]},
                               "map": {"within_1.5m": {"f_1cm": 0.9}},
                               "steps": {"mapping": {"ate_se3_pct": 1.5}}})");
  const ComparisonRow row = MakeRow({"beach", "rig", "a.b=1", 2}, folder_.Path());
  EXPECT_EQ(row["part"], "beach");
  EXPECT_EQ(row["repeat"], 2);
  EXPECT_EQ(row["exit"], 3);
  EXPECT_EQ(row["coverage_pct"], 75.0);
  EXPECT_EQ(row["ate_se3_pct"], 0.25);
  EXPECT_EQ(row["drift_5m_pct"], 0.75);
  EXPECT_TRUE(row["drift_10m_pct"].is_null());
  EXPECT_EQ(row["f_1cm_within_1.5m"], 0.9);
  EXPECT_EQ(row["mapping_ate_pct"], 1.5);
  EXPECT_EQ(row["seconds_per_pair"], 0.5);
  EXPECT_EQ(row["peak_rss_mb"], 300.0);
  EXPECT_TRUE(row["rock_shift_mm"].is_null());
}

TEST_F(Comparison, TakesWhatAPrismSaysAndTellsThatItIsHorizontal) {
  WriteSummary("ok", "[]");
  Write("evaluation.json",
        R"({"truth_path_m": 4.1, "rms_se2_m": 0.0032, "rms_se2_pct": 0.078,
            "scale_truth_over_est": 0.996, "steps": {"mapping": {"rms_se2_pct": 0.5}}})");
  const ComparisonRow row = MakeRow({"yard", "rig", "", 0}, folder_.Path());
  EXPECT_EQ(row["judged_by"], kPrismJudge);
  EXPECT_EQ(row["ate_se3_m"], 0.0032);
  EXPECT_EQ(row["ate_se3_pct"], 0.078);
  EXPECT_EQ(row["path_m"], 4.1);
  EXPECT_NEAR(row["scale_error_pct"], 0.4, 1e-9);
  EXPECT_EQ(row["mapping_ate_pct"], 0.5);
  EXPECT_TRUE(row["height_rms_m"].is_null());
  const std::string table = FormatComparison(WriteComparison({row}));
  EXPECT_THAT(table, HasSubstr("0.0780 h"));
  EXPECT_THAT(table, HasSubstr("\nh: horizontal, beside the track of a prism\n"));
}

TEST_F(Comparison, TakesWhatFixesSayWithTheirNoiseBesideIt) {
  WriteSummary("ok", "[]");
  const RunName name{"beach", "rig", "", 0};
  EXPECT_THAT(FormatComparison(WriteComparison({MakeRow(name, folder_.Path())})),
              Not(HasSubstr("RTK")));
  Write("evaluation.json",
        R"({"rtk": {"rms_residual_m": 0.012, "noise_m": 0.0115, "rms_pct": 0.15, "noise_pct": 0.14,
                    "height_rms_m": 0.02, "height_noise_m": 0.018, "height_drift_pct": 0.3,
                    "height_drift_noise_pct": 0.2, "scale_error_pct": 0.11, "scale_noise": 0.002,
                    "drift": [{"segment_m": 5.0, "horizontal_pct": 0.4,
                               "horizontal_noise_pct": 0.3}]}})");
  const ComparisonRow row = MakeRow(name, folder_.Path());
  EXPECT_EQ(row["rtk_noise_pct"], 0.14);
  EXPECT_EQ(row["rtk_height_drift_pct"], 0.3);
  EXPECT_EQ(row["rtk_height_drift_noise_pct"], 0.2);
  EXPECT_NEAR(row["rtk_scale_noise_pct"], 0.2, 1e-12);
  EXPECT_EQ(row["rtk_drift_5m_pct"], 0.4);
  EXPECT_EQ(row["rtk_drift_noise_5m_pct"], 0.3);
  EXPECT_TRUE(row["rtk_drift_10m_pct"].is_null());
  const std::string table = FormatComparison(WriteComparison({row}));
  EXPECT_THAT(table, HasSubstr("0.0120 (0.0115)"));
  EXPECT_THAT(table, HasSubstr("0.0200 (0.0180)"));
}

TEST_F(Comparison, TableShowsEveryKindOfErrorThatIsKnown) {
  WriteSummary("ok", "[]");
  const RunName name{"beach", "rig", "", 0};
  Write("evaluation.json",
        R"({"ate_se3_m": 0.01, "drift": {"height_drift_pct": 0.031, "segments": [
                {"segment_m": 5.0, "rpe_t_pct": 0.412}, {"segment_m": 25.0, "rpe_t_pct": 0.213}]},
            "map": {"within_3.5m": {"f_1cm": 0.931}},
            "rocks": {"found": 4, "shift_max_mm": 5.2, "top_max_mm": 8.4, "ghost_max_pct": 1.3}})");
  const std::string table = FormatComparison(WriteComparison({MakeRow(name, folder_.Path())}));
  for (const char* shown : {"height drift %", "5 m %", "25 m %", "F 3.5 m", "rocks", "top mm",
                            "ghosts %", "0.031", "0.412", "0.213", "0.931", "8.4", "1.3"}) {
    EXPECT_THAT(table, HasSubstr(shown));
  }
  EXPECT_THAT(table, Not(HasSubstr("50 m %")));
}

TEST_F(Comparison, RowNeedsASummary) {
  EXPECT_THAT(MessageOf<DataError>([&] { MakeRow({}, folder_.Path()); }),
              HasSubstr("no summary.json"));
  Write("summary.json", "{}");
  EXPECT_THAT(MessageOf<DataError>([&] { MakeRow({}, folder_.Path()); }),
              HasSubstr("expected the summary of a run"));
}

TEST_F(Comparison, MediansCountRunsThatFailedAndLeaveTheirNumbersOut) {
  WriteSummary("ok", "[]");
  std::vector<ComparisonRow> rows;
  for (const double ate_pct : {0.1, 0.4, 0.2}) {
    rows.push_back(MakeRow({"beach", "sfm", "", static_cast<int>(rows.size())}, folder_.Path()));
    rows.back()["ate_se3_pct"] = ate_pct;
  }
  rows.push_back(MakeFailedRow({"beach", "sfm", "", 3}, 1, "COLMAP made no model"));
  rows.push_back(MakeFailedRow({"beach", "wheels", "", 0}, 1, "no odometry.txt"));
  for (const auto& [name, value] : rows.front().items()) {
    ASSERT_TRUE(rows.back().contains(name)) << name;
  }
  EXPECT_TRUE(rows.back()["verdict"].is_null());
  EXPECT_TRUE(rows.back()["seconds"].is_null());
  const auto comparison = WriteComparison(rows);
  EXPECT_EQ(comparison["rows"].size(), 5U);
  ASSERT_EQ(comparison["medians"].size(), 2U);
  const auto& sfm = comparison["medians"][0];
  EXPECT_EQ(sfm["runs"], 4);
  EXPECT_EQ(sfm["ok"], 3);
  EXPECT_EQ(sfm["failed"], 1);
  EXPECT_EQ(sfm["ate_se3_pct"]["median"], 0.2);
  EXPECT_NEAR(sfm["ate_se3_pct"]["spread"].get<double>(), 0.3, 1e-12);
  EXPECT_TRUE(comparison["medians"][1]["ate_se3_pct"].is_null());
  const std::string table = FormatComparison(comparison);
  EXPECT_THAT(table, HasSubstr("3/0/1"));
  EXPECT_THAT(table, HasSubstr("0.2000±0.1500"));
}

TEST_F(Comparison, CsvHasACellForEachColumnAndQuotesWords) {
  WriteSummary("ok", "[]");
  const std::string csv =
      WriteComparisonCsv({MakeRow({"beach", "rig", "", 0}, folder_.Path()),
                          MakeFailedRow({"beach", "icp", "", 0}, 1, "expected one, found none")});
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < csv.size(); at = csv.find('\n', at) + 1) {
    lines.push_back(csv.substr(at, csv.find('\n', at) - at));
  }
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_THAT(lines[0],
              StartsWith("part,technique,setting,repeat,run,truth,exit,status,reason,verdict,"));
  EXPECT_THAT(lines[1], HasSubstr("\"good \"\"enough\"\"\""));
  EXPECT_THAT(lines[2],
              HasSubstr("\"icp\",\"\",0,\"\",\"\",1,\"failed\",\"expected one, found none\","));
  EXPECT_EQ(std::ranges::count(lines[0], ','), std::ranges::count(lines[1], ','));
}

TEST(ParseSweepTest, TakesAnOptionWithItsValues) {
  const Sweep sweep = ParseSweep("mapping.method=seeded,none");
  EXPECT_EQ(sweep.option, "mapping.method");
  EXPECT_THAT(sweep.values, ElementsAre("seeded", "none"));
  for (const char* wrong : {"mapping.method", "method=a", "mapping.method=", "a.b=1,,2"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ParseSweep(wrong); }), HasSubstr(wrong)) << wrong;
  }
}

TEST_F(Comparison, NamesSettingsByWhichNoFigureDiffers) {
  const auto row = [](const std::string& setting, double ate, double seconds) {
    return ComparisonRow{{"part", "1"},      {"technique", "icp"}, {"setting", setting},
                         {"repeat", 0},      {"run", setting},     {"status", "ok"},
                         {"ate_se3_m", ate}, {"seconds", seconds}, {"peak_rss_mb", seconds}};
  };
  EXPECT_THAT(
      SettingsWithoutEffect({row("", 1.0, 5.0), row("a.b=1", 1.0, 6.0), row("a.b=2", 2.0, 5.0)}),
      ElementsAre("1, icp: no figure differs between '', 'a.b=1'"));
  EXPECT_TRUE(SettingsWithoutEffect({row("", 1.0, 5.0), row("a.b=1", 1.5, 5.0)}).empty());
}

}  // namespace
}  // namespace rigmap
