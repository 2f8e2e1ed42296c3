#include "report/write_report.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/file.h"
#include "report/bundle.h"
#include "tests/report/sample_result.h"
#include "tests/support/message_of.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string ReportOf(const fs::path& root) {
  WriteReport({.folder = root, .changed_options = {"dense.method=<i>bm</i> (default sgm)"}});
  return ReadTextFile(root / "report.html");
}

class WriteReportTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(WriteReportTest, TellsTheVerdictFirst) {
  const std::string report = ReportOf(WriteSampleResult(folder_));
  EXPECT_LT(report.find("This result can be trusted"), report.find("<section"));
  EXPECT_THAT(report, HasSubstr("etres good to 0.31\u00a0%"));
  EXPECT_THAT(report, HasSubstr("registered"));
}

TEST_F(WriteReportTest, SaysSoOfEachStatus) {
  for (const auto& [status, words] :
       {std::pair{"untrusted", "Do not trust"}, std::pair{"failed", "The run failed"},
        std::pair{"partial", "Not judged yet"}}) {
    EXPECT_THAT(ReportOf(WriteSampleResult(folder_, status, SampleSummary(status))),
                HasSubstr(words));
  }
}

TEST_F(WriteReportTest, DoesNotCallTrustedWhatNothingMeasured) {
  Json summary = SampleSummary();
  summary["verdict"]["scale_95_pct"] = nullptr;
  const std::string report = ReportOf(WriteSampleResult(folder_, "stood", summary));
  EXPECT_THAT(report, HasSubstr("Consistent, but nothing checked its metres"));
  EXPECT_THAT(report, Not(HasSubstr("can be trusted")));
}

TEST_F(WriteReportTest, DrawsNoSigmaWhereNoneIsKnown) {
  const fs::path root = WriteSampleResult(folder_);
  const std::string chart = "sigma of the position, mm";
  ASSERT_THAT(ReportOf(root), AllOf(HasSubstr(chart), Not(HasSubstr("\"sx\":[null"))));
  const std::string unknown = "nan,nan,nan,nan,nan,nan,adjusted,1\n";
  folder_.Write("result/trajectory.csv",
                "stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source,keyframe\n"
                "1000000000,0,0,1,0,0,0,1," +
                    unknown + "2000000000,1,0,1,0,0,0,1," + unknown);
  EXPECT_THAT(ReportOf(root), AllOf(Not(HasSubstr(chart)), HasSubstr("\"sx\":[null,null]")));
}

// The same motion in sigmas and in per cent: passing one is enough.
TEST_F(WriteReportTest, CallsAGatePassedByTheOtherUnitOnlyWhereThatPassed) {
  const auto report_with = [&](double sigmas, double per_cent) {
    Json summary = SampleSummary();
    const auto add = [&](const char* name, double value, double limit) {
      summary["gates"].push_back(
          {{"name", name}, {"value", value}, {"limit", limit}, {"passed", true}, {"why", ""}});
    };
    add("motion_agreement_sigmas", sigmas, 5.0);
    add("motion_agreement_pct", per_cent, 0.5);
    return ReportOf(WriteSampleResult(folder_, "result", summary));
  };
  constexpr const char* kByTwin = "passed by the other unit";
  EXPECT_THAT(report_with(7.0, 0.1), HasSubstr(kByTwin));
  EXPECT_THAT(report_with(3.0, 0.1), Not(HasSubstr(kByTwin)));
  EXPECT_THAT(report_with(7.0, 0.9), Not(HasSubstr(kByTwin))) << "a diagnostic: neither judges";
}

TEST_F(WriteReportTest, NamesAreHarmless) {
  const std::string report =
      ReportOf(WriteSampleResult(folder_, "<script>alert(2)<", SampleSummary("failed")));
  EXPECT_THAT(report, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(report, Not(HasSubstr("<script>remark")));
  EXPECT_THAT(report, Not(HasSubstr("<b>this")));
  EXPECT_THAT(report, Not(HasSubstr("<i>bm")));
  EXPECT_THAT(report, HasSubstr("&lt;script&gt;alert(2)&lt;"));
}

TEST_F(WriteReportTest, NamesImagesThatCannotBeRead) {
  Json summary = SampleSummary();
  summary["health"]["unreadable_images"] = {"beach/LocCam_2015_11_26_15_23_36_000_0.png"};
  EXPECT_THAT(ReportOf(WriteSampleResult(folder_, "result", summary)),
              HasSubstr("<li>beach/LocCam_2015_11_26_15_23_36_000_0.png</li>"));
}

TEST_F(WriteReportTest, TellsWhatTheFixesLeaveOpenOfTheGeoreference) {
  const auto folder = WriteSampleResult(folder_);
  folder_.Write("result/georeference.json",
                Json{{"epsg", nullptr}, {"why", "columns exchanged?"}}.dump());
  EXPECT_THAT(ReportOf(folder), HasSubstr("No place is given: columns exchanged?"));
  const Json known = {{"epsg", 32631},
                      {"utm_zone", "31N"},
                      {"sigma", {{"horizontal_m", 0.004}, {"edge_m", 0.02}, {"height_m", 0.005}}},
                      {"weak", {"the fixes leave the <b>roll</b> open"}}};
  folder_.Write("result/georeference.json", known.dump());
  const std::string report = ReportOf(folder);
  EXPECT_THAT(report, HasSubstr("UTM zone 31N"));
  EXPECT_THAT(report, HasSubstr("data-from=\"georeference/sigma/edge_m\""));
  EXPECT_THAT(report, HasSubstr("<li>the fixes leave the &lt;b&gt;roll&lt;/b&gt; open</li>"));
}

TEST_F(WriteReportTest, RefersToNothingOutside) {
  std::string report = ReportOf(WriteSampleResult(folder_));
  EXPECT_THAT(report, HasSubstr("default-src 'none'"));
  const auto scripts = report.find(ReportScripts());
  if (!ReportScripts().empty()) report.erase(scripts, ReportScripts().size());
  EXPECT_THAT(report, Not(HasSubstr("http:")));
  EXPECT_THAT(report, Not(HasSubstr("https:")));
}

TEST_F(WriteReportTest, DoesWithASummaryAlone) {
  folder_.Write("bare/summary.json", SampleSummary("failed").dump());
  EXPECT_THAT(ReportOf(folder_.Path() / "bare"), HasSubstr("The run failed"));
}

TEST_F(WriteReportTest, OfAComparisonShowsTheFiguresOfTheScriptAndNoOthers) {
  const std::string figure =
      "<svg xmlns=\"http://www.w3.org/2000/svg\"><dc:title>rigmap plot-comparison</dc:title>";
  folder_.Write("compared/comparison.json", R"({"rows": []})");
  folder_.Write("compared/plots/cost.svg", figure + "</svg>");
  folder_.Write("compared/plots/a<b.svg", figure + "</svg>");
  folder_.Write("compared/plots/bad.svg", figure + "<Script>alert(1)</Script></svg>");
  folder_.Write("compared/plots/foreign.svg", "<svg></svg>");
  const fs::path elsewhere = folder_.Write("elsewhere.svg", figure + "</svg>");
  fs::create_symlink(elsewhere, folder_.Path() / "compared/plots/link.svg");
  const std::string report = ReportOf(folder_.Path() / "compared");
  EXPECT_THAT(report, HasSubstr("<img alt=\"cost\" src=\"data:image/svg+xml;base64,PHN2Zy"));
  EXPECT_THAT(report, HasSubstr("<img alt=\"a&lt;b\""));
  for (const char* name : {"\"bad\"", "\"foreign\"", "\"link\""}) {
    EXPECT_THAT(report, Not(HasSubstr(std::string("<img alt=") + name)));
  }
}

TEST_F(WriteReportTest, LeavesAnOlderReportWhereItCannotBeMade) {
  folder_.Write("foreign/report.html", "old");
  MessageOf<DataError>([&] { WriteReport({.folder = folder_.Path() / "foreign"}); });
  EXPECT_EQ(ReadTextFile(folder_.Path() / "foreign" / "report.html"), "old");
}

TEST_F(WriteReportTest, OfThreeThousandFramesIsThinned) {
  const auto root = WriteSampleResult(folder_);
  folder_.Write("result/trajectory.csv", SampleTrajectory(3000, 0.02));
  cv::Mat image(768, 1024, CV_8UC3);
  cv::theRNG().state = 1;
  cv::randu(image, 0, 256);  // compresses worse than any scene
  cv::imwrite((folder_.Path() / "image.jpg").string(), image);
  for (int i = 0; i < 3000; ++i) {
    const auto link = root / "colmap/images/left" /
                      fmt::format("{}.jpg", 1'000'000'000'000 + 1'000'000'000LL * i);
    fs::create_directories(link.parent_path());
    fs::create_symlink(folder_.Path() / "image.jpg", link);
  }
  const std::string report = ReportOf(root);
  EXPECT_LT(report.size(), 40'000'000U);
  EXPECT_THAT(report, HasSubstr("data-frame=\"2995\""));
}

}  // namespace
}  // namespace rigmap
