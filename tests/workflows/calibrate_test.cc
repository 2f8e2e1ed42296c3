// Pools of result folders, and what a part that is in one is given.
#include "workflows/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adjustment/calibration_prior.h"
#include "adjustment/pool_calibrations.h"
#include "core/error.h"
#include "core/file.h"
#include "dataset/rig_file.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/simulated_part.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"
#include "workflows/rig_prior.h"
#include "workflows/stages/calibration_output.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

using Frames = std::vector<std::string>;
using Arguments = std::vector<std::string>;

nlohmann::json JsonIn(const fs::path& path) { return nlohmann::json::parse(ReadTextFile(path)); }

class CalibrateTest : public testing::Test {
 protected:
  // Eight stretches of a rig that is turned by 0.1 degrees about y and shifted by half a pixel; the
  // part had been given `given` and left it as it was.
  CalibrationEquations Tell(const StereoRig& given) {
    const CalibrationVector sigmas = PriorOf(start_, {}).sigmas;
    CalibrationVector off = CalibrationVector::Zero();
    off(kRotationY) = 0.1 / 57.3;
    off(kRightCx) = 0.5;
    const CalibrationVector from_given = CorrectionBetween(given, Corrected(start_, off));
    CalibrationEquations equations;
    for (int stretch = 0; stretch < 8; ++stretch) {
      CalibrationBlock block;
      block.information.diagonal() = 100.0 * sigmas.cwiseAbs2().cwiseInverse();
      CalibrationVector told = from_given;
      for (int i = 0; i < kCalibrationSize; ++i) told(i) += random_.Normal(sigmas(i) / 10.0);
      block.score = block.information * told;
      equations.stretches.push_back(block);
      equations.score += block.score;
      equations.information += block.information;
    }
    equations.regions = equations.stretches;
    equations.score_covariance = equations.information;
    return equations;
  }
  // A result folder with what a part of these frames told when it was given this file.
  fs::path Part(const std::string& name, const Frames& frames, const PooledRig& file) {
    Dataset dataset;
    dataset.rig = file.rig;
    dataset.rig_pool = file.pool;
    if (const auto prior = WithoutPart(file, frames)) dataset.rig = prior->rig;
    DatasetContent content;
    content.images = frames;
    content.images.push_back("");  // a black frame
    Adjustment adjustment;
    adjustment.calibration = Tell(dataset.rig);
    const fs::path out = folder_.Path() / name;
    Publication publication(out, {"calibration.json"});
    fs::create_directories(out);
    PublishCalibration(dataset, content, adjustment, publication);
    return out;
  }
  PooledRig Pool(const std::vector<fs::path>& outs) const {
    const fs::path path = folder_.Path() / "pooled.yaml";
    Calibrate({outs, path});
    return ReadPooledRigFile(path);
  }
  std::string Complaint(const std::vector<fs::path>& outs) const {
    return MessageOf<DataError>([&] { Pool(outs); });
  }

  TemporaryFolder folder_;
  SeededRandom random_;
  const StereoRig start_ = SmallRoverRig();
};

void ExpectSameKnowledge(const StereoRig& a, const StereoRig& b) {
  const CalibrationVector sigmas = PriorOf(b, {}).sigmas;
  EXPECT_LT(CorrectionBetween(a, b).cwiseQuotient(sigmas).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_TRUE(PriorOf(a, {}).information.isApprox(PriorOf(b, {}).information, 0.02));
}

// To three sigmas of both.
void ExpectAgree(const StereoRig& a, const StereoRig& b) {
  const CalibrationVector variances =
      PriorOf(a, {}).sigmas.cwiseAbs2() + PriorOf(b, {}).sigmas.cwiseAbs2();
  EXPECT_LT(CorrectionBetween(a, b).cwiseQuotient(variances.cwiseSqrt()).cwiseAbs().maxCoeff(),
            3.0);
}

// About the right eye's turn sideways, which all parts tell equally well.
double Known(const StereoRig& rig) { return PriorOf(rig, {}).information(kRotationY, kRotationY); }

TEST_F(CalibrateTest, APartOfThePoolIsGivenWhatTheOthersTell) {
  const fs::path a = Part("a", {"a1", "a2"}, {start_, {}}), b = Part("b", {"b1"}, {start_, {}});
  const PooledRig both = Pool({a, b}), alone = Pool({b});
  const auto prior = WithoutPart(both, {"a1", "a2"});
  ASSERT_TRUE(prior);
  EXPECT_THAT(prior->remark, HasSubstr("the rig file contains this part"));
  ExpectSameKnowledge(prior->rig, alone.rig);
  // Twice as much is known of the pool.
  EXPECT_GT(Known(both.rig), 1.5 * Known(prior->rig));
  // A few frames of it are enough, another part is given all.
  EXPECT_TRUE(WithoutPart(both, {"x", "a2"}));
  EXPECT_FALSE(WithoutPart(both, {"x", ""}));
  // Of a pool of one, and for frames of both, nothing that it told is left.
  ExpectSameKnowledge(WithoutPart(alone, {"b1"})->rig, start_);
  const auto across = WithoutPart(both, {"a2", "b1"});
  ExpectSameKnowledge(across->rig, start_);
  EXPECT_THAT(across->remark, HasSubstr("several"));
}

// What the images do not tell stays the file's: a map without its masks shows the rover.
TEST_F(CalibrateTest, MasksAntennaAndBaselinesSigmaStayInTheFile) {
  PooledRig given{start_, {}};
  given.rig.left.mask_path = folder_.Write("left.png", "").string();
  const PooledRig pooled = Pool({Part("a", {"a"}, given), Part("b", {"b"}, given)});
  EXPECT_EQ(pooled.rig.left.mask_path, given.rig.left.mask_path);
  // Written into the pooled file since; then both parts anew with it, and pooled once more.
  PooledRig more = pooled;
  more.rig.antenna_in_left = Eigen::Vector3d(0.1, -0.5, 0.0);
  more.rig.baseline_sigma_m = 1e-4;
  const PooledRig again = Pool({Part("a", {"a"}, more), Part("b", {"b"}, more)});
  EXPECT_EQ(again.rig.left.mask_path, given.rig.left.mask_path);
  EXPECT_EQ(again.rig.antenna_in_left, more.rig.antenna_in_left);
  EXPECT_EQ(again.rig.baseline_sigma_m, more.rig.baseline_sigma_m);
  ExpectAgree(again.rig, pooled.rig);
}

// No pixel of it is needed.
TEST_F(CalibrateTest, AMaskMayHaveMovedSince) {
  PooledRig given{start_, {}};
  given.rig.left.mask_path = folder_.Write("left.png", "").string();
  const fs::path a = Part("a", {"a"}, given), b = Part("b", {"b"}, given);
  fs::remove(given.rig.left.mask_path);
  EXPECT_EQ(Pool({a, b}).rig.left.mask_path, given.rig.left.mask_path);
}

TEST_F(CalibrateTest, ThePriorIsThatOfTheParts) {
  const fs::path a = Part("a", {"a"}, {start_, {}}), b = Part("b", {"b"}, {start_, {}});
  const double known = Known(Pool({a, b}).rig);
  const std::string narrow = "adjustment:\n  rig_prior_deg: 0.001\n";
  folder_.Write("a/config.yaml", narrow);
  folder_.Write("b/config.yaml", narrow);
  // Not by the hundredfold: these images contradict it.
  EXPECT_GT(Known(Pool({a, b}).rig), 1.02 * known);
  folder_.Write("b/config.yaml", "adjustment:\n  rig_prior_deg: 0.002\n");
  EXPECT_THAT(Complaint({a, b}), HasSubstr("b/config.yaml: expected the options of adjustment"));
}

TEST_F(CalibrateTest, PartsOfFilesThatStateOtherSigmasAreRefused) {
  StereoRig stated = start_;
  stated.stated_sigmas.board_px = 0.2;
  EXPECT_THAT(Complaint({Part("a", {"a"}, {start_, {}}), Part("b", {"b"}, {stated, {}})}),
              HasSubstr("expected a part made with the rig file of"));
}

// To make better what is only not good enough is what a pool is for.
TEST_F(CalibrateTest, WhatContradictsItselfIsNamedInTheFile) {
  const fs::path a = Part("a", {"a"}, {start_, {}}), b = Part("b", {"b"}, {start_, {}});
  const auto file = [&](const char* gate) {
    const nlohmann::json cause = {{"brief", "the map is bent"}, {"gates", {"scale_95_pct", gate}}};
    folder_.Write(
        "b/summary.json",
        nlohmann::json({{"status", "untrusted"}, {"verdict", {{"causes", {cause}}}}}).dump());
    Pool({a, b});
    return ReadTextFile(folder_.Path() / "pooled.yaml");
  };
  EXPECT_THAT(file("position_95_pct"), testing::Not(HasSubstr("Not trusted")));
  EXPECT_THAT(file("epipolar_px"),
              testing::StartsWith("# A rig as 2 parts tell it together.\n# Not trusted, and in it "
                                  "all the same: " +
                                  b.string() + ": the map is bent\n"));
  folder_.Write("b/summary.json", "{}");
  EXPECT_THAT(Complaint({a, b}), HasSubstr("b/summary.json: expected what rigmap part writes"));
}

TEST_F(CalibrateTest, PartsRunWithAPoolCountOnceInTheNext) {
  const fs::path a = Part("a", {"a"}, {start_, {}}), b = Part("b", {"b"}, {start_, {}});
  const PooledRig first = Pool({a, b});
  const fs::path c = Part("c", {"c"}, first);
  // One that the pool did not contain adds to it, and all three can be left out. Nobody knows more
  // than their number allows.
  const PooledRig added = Pool({c}), all = Pool({a, b, c});
  ASSERT_EQ(added.pool->parts.size(), 3U);
  ExpectAgree(added.rig, all.rig);
  EXPECT_LT(Known(added.rig), 1.05 * Known(all.rig));
  for (const char* part : {"a", "b", "c"}) {
    const StereoRig without = WithoutPart(added, {part})->rig;
    ExpectAgree(without, WithoutPart(all, {part})->rig);
    EXPECT_LT(Known(without), 1.05 * Known(WithoutPart(all, {part})->rig)) << part;
  }
  ExpectSameKnowledge(WithoutPart(added, {"c"})->rig, first.rig);
  // Those that it contained count as in the first.
  const PooledRig again = Pool({Part("a2", {"a"}, first), Part("b2", {"b"}, first)});
  ASSERT_EQ(again.pool->parts.size(), 2U);
  ExpectAgree(again.rig, first.rig);
  EXPECT_NEAR(Known(again.rig) / Known(first.rig), 1.0, 0.1);
}

TEST_F(CalibrateTest, RefusesAPoolWhoseCorrectionsLeaveNoRig) {
  PooledRig pooled = Pool({Part("a", {"a"}, {start_, {}}), Part("b", {"b"}, {start_, {}})});
  pooled.pool->parts[0].correction(kLogFocal) = 40.0;
  EXPECT_THAT(MessageOf<DataError>([&] { WithoutPart(pooled, {"a"}); }),
              AllOf(HasSubstr("expected corrections of a pool that leave a rig, found that of the "
                              "part with frame a: corrected:"),
                    HasSubstr("expected a focal length in pixels")));
  EXPECT_TRUE(WithoutPart(pooled, {"b"}));
}

TEST_F(CalibrateTest, RefusesWhatCountsTwiceOrIsOfAnotherRig) {
  const fs::path a = Part("a", {"f1", "f2"}, {start_, {}}),
                 b = Part("b", {"f2", "f3"}, {start_, {}});
  EXPECT_THAT(Complaint({a, b}),
              HasSubstr("found 1 of " + a.string() + ": they would count twice"));
  StereoRig other = start_;
  other.left.camera.cx += 1.0;
  EXPECT_THAT(Complaint({a, Part("c", {"c"}, {other, {}})}), HasSubstr("found another"));
}

TEST_F(CalibrateTest, RefusesADamagedCalibrationByName) {
  const fs::path path = Part("a", {"f1", "f2"}, {start_, {}}) / "calibration.json";
  using nlohmann::json;
  const json whole = JsonIn(path);
  const auto complaint = [&](const char* where, const json& value) {
    json damaged = whole;
    damaged[json::json_pointer(where)] = value;
    WriteTestFile(path, damaged.dump());
    return Complaint({path.parent_path()});
  };
  const std::string file = path.string() + ": expected ";
  EXPECT_EQ(complaint("/correction", {1, 2, 3}), file + "19 numbers, found 3");
  EXPECT_THAT(complaint("/frames", 5), HasSubstr(file + "what rigmap part writes there"));
  EXPECT_THAT(complaint("/stretches/0/information/1", 1e30), HasSubstr(file + "information"));
  EXPECT_THAT(complaint("/regions/0/information/0", -1e30), HasSubstr(file + "information"));
}

TEST(RigOut, ReplacesNothingButWhatACalibrationWrote) {
  const TemporaryFolder folder;
  const fs::path data = WriteTestFile(folder.Path() / "times.txt", "1 2 3\n");
  const auto refusal = [&](const fs::path& rig_out) {
    return MessageOf<DataError>([&] { Calibrate({{folder.Path() / "part"}, rig_out}); });
  };
  EXPECT_THAT(refusal(data), HasSubstr("expected a rig file that rigmap calibrate has written"));
  const fs::path own = WriteTestFile(folder.Path() / "calib.yaml", "left:\n  model: PINHOLE\n");
  EXPECT_THAT(refusal(own), HasSubstr("calib.yaml: expected a rig file that rigmap calibrate"));
  EXPECT_EQ(ReadTextFile(data), "1 2 3\n");
  EXPECT_THAT(refusal(folder.Path()), HasSubstr("expected a file to write to, found a folder"));
  EXPECT_THAT(refusal(folder.Path() / "none" / "rig.yaml"), HasSubstr("expected a folder for"));
  EXPECT_FALSE(fs::exists(folder.Path() / "none"));
  // What is asked of the output is asked first.
  EXPECT_THAT(refusal(folder.Path() / "rig.yaml"), HasSubstr("part: expected calibration.json"));
}

// The file that both halves of a drive tell gives each what the other one told, wherever its images
// lie, and all to a third.
TEST(CalibratedParts, TakeThePriorWithoutTheirOwnImages) {
  const TemporaryFolder folder;
  const fs::path data = CopyOfSimulatedPart(folder.Path()), moved = folder.Path() / "moved",
                 out = folder.Path() / "out";
  fs::create_directories(out);
  std::string rig = ReadTextFile(data / "calib.yaml");
  rig.replace(rig.find("161.7"), 5, "163.7");
  WriteTestFile(data / "calib.yaml", rig);
  const auto run = [&](const fs::path& dataset, const char* frames, const char* name,
                       const Arguments& more = {}) {
    Arguments arguments{"part",  "--dataset", dataset,   "--frames",  frames,
                        "--out", out / name,  "--until", "adjustment"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  };
  const auto pooled_of = [&](const Arguments& outs) {
    const fs::path path = folder.Path() / "pooled.yaml";
    Arguments arguments{"calibrate", "--rig-out", path};
    for (const std::string& name : outs) arguments.push_back(out / name);
    const ProgramEnd end = RunRigmap(arguments);
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return path;
  };
  const auto prior_of = [&](const char* name) {
    return ParseRigFile(JsonIn(out / name / "calibration.json")["rig"], "rig");
  };
  run(data, "0:4", "first");
  run(data, "4:8", "second");
  const StereoRig second = ReadRigFile(pooled_of({"second"}));
  const fs::path pooled = pooled_of({"first", "second"});
  fs::rename(data, moved);
  const ProgramEnd again = run(moved, "0:3", "again", {"--rig", pooled});
  EXPECT_THAT(again.err, testing::HasSubstr("the rig file contains this part"));
  EXPECT_THAT(JsonIn(out / "again" / "summary.json")["health"]["remarks"].dump(),
              testing::HasSubstr("its prior leaves it out"));
  const StereoRig prior = prior_of("again");
  EXPECT_NEAR(prior.right.camera.cx, second.right.camera.cx, 1e-9);
  ASSERT_TRUE(prior.calibration_covariance);
  EXPECT_TRUE(prior.calibration_covariance->isApprox(*second.calibration_covariance, 1e-6));
  // Frames that are not in it take the pool's own.
  const fs::path of_second = pooled_of({"second"});
  const ProgramEnd other = run(moved, "0:4", "other", {"--rig", of_second});
  EXPECT_THAT(other.err, testing::Not(testing::HasSubstr("contains")));
  EXPECT_TRUE(
      prior_of("other").calibration_covariance->isApprox(*second.calibration_covariance, 1e-6));
}

}  // namespace
}  // namespace rigmap
