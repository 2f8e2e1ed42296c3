#include "workflows/evaluate_part.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// A straight drive of two metres, and the same drawn out by 10 %.
class EvaluatePartTest : public testing::Test {
 protected:
  EvaluatePartTest() {
    std::string straight, longer;
    for (int i = 0; i <= 20; ++i) {
      const std::string at = std::to_string(i) + ".0 ";
      straight += at + std::to_string(0.1 * i) + " 0 0 0 0 0 1\n";
      longer += at + std::to_string(0.11 * i) + " 0 0 0 0 0 1\n";
    }
    fs::create_directories(out_);
    fs::create_directories(folder_.Path() / "truth");
    WriteTestFile(out_ / "trajectory.tum", straight);
    truth_ = WriteTestFile(folder_.Path() / "truth" / "trajectory.tum", longer);
  }
  std::string ErrorOf(const EvaluateRequest& request) {
    try {
      EvaluatePart(request);
    } catch (const DataError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out", truth_;
};

TEST_F(EvaluatePartTest, ComparesWithAFileOrWithThatOfAFolder) {
  const std::string line = EvaluatePart({out_, truth_, true});
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const json metrics = json::parse(line);
  EXPECT_NEAR(metrics["scale"].get<double>(), 1.1, 1e-4);
  EXPECT_NEAR(metrics["ate_sim3_m"].get<double>(), 0.0, 1e-5);
  EXPECT_EQ(EvaluatePart({out_, truth_.parent_path(), true}), line);
}

TEST_F(EvaluatePartTest, SaysFirstWhetherTheResultIsTrusted) {
  const std::string metrics = EvaluatePart({out_, truth_, false});
  const auto with = [&](const std::string& status, const std::string& text) {
    WriteTestFile(out_ / "summary.json",
                  R"({"status": ")" + status + R"(", "verdict": {"text": )" + text + "}}");
    return EvaluatePart({out_, truth_, false});
  };
  EXPECT_EQ(with("ok", R"("metres good to 1 %", "scale_95_pct": 12)"),
            "trusted: metres good to 1 %\nscale off by 10 %, within the 12 % stated\n" + metrics);
  EXPECT_EQ(with("ok", R"("nothing checks the metres", "scale_95_pct": null)"),
            "consistent: nothing checks the metres\n" + metrics);
  EXPECT_EQ(with("untrusted", R"("torn")"), "NOT TRUSTED: torn\n" + metrics);
  EXPECT_EQ(with("partial", "null"), "partial\n" + metrics);
  WriteTestFile(out_ / "summary.json", "{}");
  EXPECT_THAT(ErrorOf({out_, truth_, false}), HasSubstr("summary.json: expected the summary"));
}

TEST_F(EvaluatePartTest, SaysWhetherTheTruthBearsOutWhatIsStated) {
  const auto with = [&](const std::string& stated) {
    WriteTestFile(out_ / "summary.json",
                  R"({"status": "ok", "verdict": {"text": null, "scale_95_pct": )" + stated + "}}");
    return EvaluatePart({out_, truth_, false});
  };
  EXPECT_THAT(with("12.0"), HasSubstr("\nscale off by 10 %, within the 12 % stated\n"));
  EXPECT_THAT(with("2.5"), HasSubstr("\nscale off by 10 %, more than the 2.5 % stated: this or"));
  EXPECT_THAT(with("250.0"), HasSubstr("\nscale off by 10 %, within the 250 % stated\n"));
  EXPECT_THAT(with("null"), testing::Not(HasSubstr("scale off by")));
}

TEST(DoubtOfTruthTest, IsOfFewPosesAndOfAnotherLength) {
  const auto doubt = [](double coverage, double path_m) {
    return DoubtOfTruth({{"frames", 127},
                         {"gt_frames", 88},
                         {"coverage", coverage},
                         {"path_m", path_m},
                         {"est_path_m", 4.2}});
  };
  EXPECT_EQ(doubt(1.0, 4.1), "");
  EXPECT_EQ(doubt(0.73, 8.3), "");  // 64 of 127 moments
  EXPECT_EQ(doubt(0.034, 4.1), "poses at 3 of the result's 127 moments only");
  EXPECT_EQ(doubt(1.0, 73.385), "a path of 73.39 m, where the result has 4.20 m");
  EXPECT_EQ(doubt(1.0, 1.0), "a path of 1.00 m, where the result has 4.20 m");
  EXPECT_EQ(DoubtOfTruth({{"frames", 9}, {"error", "fewer than 3 matched poses"}}),
            "fewer than 3 matched poses");
  EXPECT_EQ(DoubtOfTruth({{"frames", 9}, {"est_path_m", 4.0}, {"truth_path_m", 4.1}}), "");
}

TEST_F(EvaluatePartTest, ComparesAsTheRunWasConfigured) {
  WriteTestFile(out_ / "config.yaml", "evaluation: {segment_m: 0.77}\n");
  const json metrics = json::parse(EvaluatePart({out_, truth_, true}));
  EXPECT_NEAR(metrics["segment_m"].get<double>(), 0.77, 1e-9);
}

TEST_F(EvaluatePartTest, PrintsATableForPeople) {
  const std::string table = EvaluatePart({out_, truth_, false});
  EXPECT_THAT(table, HasSubstr("ate_se3_m              0."));
  EXPECT_THAT(table, HasSubstr("frames                 21\n"));
}

TEST_F(EvaluatePartTest, PrintsInnerValuesByNameAndListsAsTables) {
  WriteTestFile(out_ / "evaluation.json",
                R"({"map": {"within_1.5m": {"f_1cm": 0.9}},
                    "rocks": {"each": [{"size": "small", "x": 1.5}, {"size": "large", "y": [2, 3]}]}})");
  EXPECT_EQ(EvaluatePart({out_, {}, false}),
            "map.within_1.5m.f_1cm 0.9\n"
            "rocks.each\n"
            "   size    x      y\n"
            "  small  1.5      -\n"
            "  large    -  [2,3]\n");
}

TEST_F(EvaluatePartTest, ShowsWhatTheRunFoundWhereNoTruthIsGiven) {
  WriteTestFile(out_ / "evaluation.json", "{\n \"frames\": 3,\n \"scale\": 1.5\n}\n");
  EXPECT_EQ(EvaluatePart({out_, {}, true}), "{\"frames\":3,\"scale\":1.5}\n");
}

// The first lines of a file.
std::string FirstLines(const fs::path& path, int count) {
  const std::string text = ReadTextFile(path);
  std::size_t end = 0;
  for (int line = 0; line < count; ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

// A run of some frames is judged by the way that it drove.
TEST_F(EvaluatePartTest, TakesPerCentOfWhatWasDriven) {
  WriteTestFile(out_ / "trajectory.tum", FirstLines(out_ / "trajectory.tum", 8));
  const json metrics = json::parse(EvaluatePart({out_, truth_, true}));
  WriteTestFile(truth_, FirstLines(truth_, 8));
  EXPECT_EQ(json::parse(EvaluatePart({out_, truth_, true})), metrics);
  EXPECT_EQ(metrics["coverage"], 1.0);
  EXPECT_EQ(metrics["gt_frames"], 8);
}

TEST_F(EvaluatePartTest, RefusesATruthOfAnotherTime) {
  std::string later;
  for (int i = 0; i <= 20; ++i) later += std::to_string(1000 + i) + ".0 0 0 0 0 0 0 1\n";
  WriteTestFile(truth_, later);
  EXPECT_THAT(ErrorOf({out_, truth_, true}),
              testing::AllOf(HasSubstr(truth_.string()), HasSubstr("0.02 s")));
}

TEST_F(EvaluatePartTest, ComparesWithTheTrackOfAPrism) {
  std::string track = "# t x y\n";
  for (int i = 0; i <= 20; ++i)
    track += std::to_string(i) + " 5 " + std::to_string(0.11 * i) + "\n";
  fs::create_directories(out_ / "steps");
  fs::copy(out_ / "trajectory.tum", out_ / "steps" / "odometry.tum");
  const auto yard = folder_.Path() / "yard";
  fs::create_directories(yard);
  WriteTestFile(out_ / "steps" / "notes.txt", "no trajectory");
  const auto file = WriteTestFile(yard / "groundtruth_xy.txt", track);
  const json metrics = json::parse(EvaluatePart({out_, yard, true}));
  EXPECT_NEAR(metrics["scale_truth_over_est"].get<double>(), 1.1, 0.01);
  EXPECT_GT(metrics["rms_se2_m"], 10.0 * metrics["rms_sim2_m"].get<double>());
  EXPECT_EQ(metrics["steps"]["odometry"]["rms_se2_m"], metrics["rms_se2_m"]);
  EXPECT_EQ(metrics["steps"].size(), 1u);
  const auto other = WriteTestFile(folder_.Path() / "prism.txt", track);
  EXPECT_EQ(json::parse(EvaluatePart({out_, other, true})), metrics);
  WriteTestFile(file, "1 2 3\n2 x 3\n");
  EXPECT_THAT(ErrorOf({out_, yard, true}), HasSubstr("groundtruth_xy.txt:2: expected a finite"));
  WriteTestFile(file, "1001 2 3\n1002 3 3\n");
  EXPECT_THAT(ErrorOf({out_, yard, true}), HasSubstr("found 0 of its 21 poses"));
}

TEST_F(EvaluatePartTest, SaysWhatIsMissing) {
  fs::create_directories(folder_.Path() / "empty");
  EXPECT_THAT(ErrorOf({out_, {}, true}), HasSubstr("found no summary.json"));
  WriteTestFile(out_ / "summary.json", "{}");
  EXPECT_THAT(ErrorOf({out_, {}, true}), HasSubstr("ended before that stage"));
  EXPECT_THAT(ErrorOf({folder_.Path() / "nothing", truth_, true}), HasSubstr("nothing"));
  EXPECT_THAT(ErrorOf({out_, folder_.Path() / "empty", true}), HasSubstr("found none"));
  fs::create_directories(folder_.Path() / "all" / "Part3");
  fs::copy(truth_, folder_.Path() / "all" / "Part3");
  EXPECT_THAT(ErrorOf({out_, folder_.Path() / "all", true}), HasSubstr("found Part3"));
  EXPECT_THAT(ErrorOf({out_, folder_.Path() / "no.tum", true}), HasSubstr("no.tum"));
  WriteTestFile(out_ / "evaluation.json", "{\"frames\": ");
  EXPECT_THAT(ErrorOf({out_, {}, true}), HasSubstr("expected JSON"));
}

TEST_F(EvaluatePartTest, NamesTheFileThatIsOfAnotherForm) {
  WriteTestFile(out_ / "summary.json", R"({"technique": 5, "status": "ok", "verdict": 7})");
  WriteTestFile(out_ / "evaluation.json", R"({"scale_error_pct": []})");
  EXPECT_THAT(ErrorOf({out_, {}, false}), HasSubstr("evaluation.json: expected an evaluation"));
  WriteTestFile(out_ / "evaluation.json", "{}");
  EXPECT_THAT(ErrorOf({out_, {}, false}), HasSubstr("summary.json: expected the summary of a run"));
}

}  // namespace
}  // namespace rigmap
