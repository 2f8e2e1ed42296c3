#include "gates/refusal.h"

#include <gmock/gmock.h>

#include <limits>

namespace rigmap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

// A part of thirty frames over 52 m, good to 1.2 % in scale.
PartFindings Findings() {
  PartFindings findings;
  findings.accuracy = {.path_m = 52.0, .scale_95_pct = 1.2, .position_95_m = 0.8};
  findings.accuracy.noise_95_pct = 0.3;
  findings.baseline_m = 0.53717;
  findings.frames = 30;
  findings.pieces = {{0, 30}};
  return findings;
}

Gates Failing(const std::vector<std::string>& names, double value = 1.5, double limit = 1.0) {
  Gates gates{{"healthy", 0.5, 1.0, true, "of no interest"}};
  for (const std::string& name : names) gates.push_back({name, value, limit, false, "too much"});
  return gates;
}

const std::vector<std::string> kAllGates{"baseline_spread",
                                         "baseline_rejected",
                                         "registered",
                                         "unheld",
                                         "closure_sigmas",
                                         "closure_pct",
                                         "length_pct",
                                         "predicted",
                                         "breaks",
                                         "scale_95_pct",
                                         "position_95_pct",
                                         "motion_agreement_window",
                                         "motion_agreement_sigmas",
                                         "motion_agreement_pct",
                                         "motion_agreement_drift",
                                         "reprojection_px",
                                         "outlier_share",
                                         "epipolar_px",
                                         "rig_refinement_px",
                                         "infinity_offset_px",
                                         "rig_consistency_deg",
                                         "rig_consistency_sigmas",
                                         "intrinsics_consistency_pct",
                                         "intrinsics_consistency_sigmas",
                                         "depth_consistency_pct",
                                         "depth_bias_px"};

std::vector<std::string> NamesOf(const Cause& cause) {
  std::vector<std::string> names;
  for (const Gate& gate : cause.gates) names.push_back(gate.name);
  return names;
}

TEST(RefusalOf, TellsAValueFromItsLimit) {
  const auto refusal = RefusalOf(Failing({"scale_95_pct"}, 1.00124), Findings());
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found, HasSubstr("the scale is known to 1.001 %"));
}

TEST(RefusalOf, HealthyPartHasNone) {
  const Refusal refusal = RefusalOf(Failing({}), Findings());
  EXPECT_THAT(refusal.causes, IsEmpty());
  EXPECT_EQ(WarningOf(refusal), "");
}

// Whichever gate fails alone, a person learns what was found and expected, and what to do; never
// what would silence the gate and leave the cause.
TEST(RefusalOf, EachGateAloneHasOneCauseThatAPersonUnderstands) {
  for (const std::string& name : kAllGates) {
    const Refusal refusal = RefusalOf(Failing({name}), Findings());
    ASSERT_THAT(refusal.causes, SizeIs(1)) << name;
    const Cause& cause = refusal.causes[0];
    EXPECT_THAT(NamesOf(cause), ElementsAre(name));
    EXPECT_THAT(cause.found, Not(HasSubstr("too much"))) << "is not known";
    EXPECT_LE(cause.brief.size(), 70U) << cause.brief;
    EXPECT_LE(cause.found.size(), 240U) << cause.found;
    EXPECT_THAT(cause.found, testing::AnyOf(HasSubstr("expected"), HasSubstr("asked"),
                                            HasSubstr("a calibration errs by")));
    EXPECT_GT(cause.advice.size(), 20U) << name;
    for (const char* silencing : {"refine_rig", "--accuracy", "gates.", "--set"}) {
      EXPECT_THAT(cause.advice, Not(HasSubstr(silencing))) << name;
    }
  }
}

TEST(RefusalOf, AWrongRigExplainsAllThatFollows) {
  // Beach images with a rig turned by a degree: nothing is mapped, most poses are guesses.
  const Refusal refusal =
      RefusalOf(Failing({"registered", "predicted", "epipolar_px", "scale_95_pct"}), Findings());
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found, HasSubstr("do not fit the rig file"));
  EXPECT_THAT(NamesOf(refusal.causes[0]), ElementsAre("epipolar_px"));
  EXPECT_EQ(refusal.usable, "nothing");
  EXPECT_EQ(WarningOf(refusal), "not trusted: left and right images do not fit the rig file");
  EXPECT_THAT(RefusalOf(Failing(kAllGates), Findings()).causes, SizeIs(1));
}

TEST(RefusalOf, TellsCausesThatDoNotFollowInTheOrderOfTheStages) {
  const Refusal refusal = RefusalOf(
      Failing({"depth_bias_px", "outlier_share", "motion_agreement_pct", "predicted"}), Findings());
  ASSERT_THAT(refusal.causes, SizeIs(3));
  EXPECT_THAT(NamesOf(refusal.causes[0]), ElementsAre("predicted"));
  EXPECT_THAT(NamesOf(refusal.causes[1]), ElementsAre("outlier_share"));
  EXPECT_THAT(NamesOf(refusal.causes[2]), ElementsAre("depth_bias_px"));
  EXPECT_THAT(WarningOf(refusal), testing::EndsWith("; 2 more"));
}

TEST(RefusalOf, FramesThatShowNothingLeaveThoseBetween) {
  PartFindings findings = Findings();
  findings.guessed = {{12, 22}};
  findings.breaks = {22};
  findings.pieces = {{0, 12}, {22, 30}};
  const Refusal refusal =
      RefusalOf(Failing({"predicted", "scale_95_pct"}, 1.0 / 3.0, 0.2), findings, {100});
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found, AllOf(StartsWith("10 of 30 frames (112:122) show nothing"),
                                             HasSubstr("at most 20 %")));
  EXPECT_THAT(refusal.causes[0].advice, HasSubstr("--frames 100:112"));
  EXPECT_THAT(refusal.usable, StartsWith("frames 100:112 and 122:130"));
  // Where what lies before the gap is in view again behind it, only the gap is lost.
  findings.breaks.clear();
  findings.pieces = {{0, 30}};
  EXPECT_THAT(RefusalOf(Failing({"predicted"}), findings).usable,
              StartsWith("all poses but the guessed ones: metres to 1.2 %"));
  findings.guessed = {{1, 30}};
  findings.pieces.clear();
  const Refusal nothing = RefusalOf(Failing({"predicted"}), findings);
  EXPECT_EQ(nothing.usable, "nothing");
  EXPECT_THAT(nothing.causes[0].advice, Not(HasSubstr("--frames")));
}

TEST(RefusalOf, AGuessedJumpLeavesThePiecesBesideIt) {
  PartFindings findings = Findings();
  findings.breaks = {12};
  findings.pieces = {{12, 30}, {0, 12}};
  const Refusal refusal =
      RefusalOf(Failing({"breaks", "position_95_pct"}, 1.0, 0.0), findings, {100});
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found,
              HasSubstr("nothing measured joins what begins at frame 112"));
  EXPECT_THAT(refusal.causes[0].advice, HasSubstr("without gaps"));
  EXPECT_THAT(refusal.usable, StartsWith("frames 112:130 and 100:112, each by itself"));
}

// `rigmap join` takes no --frames.
TEST(RefusalOf, OfJoinedPartsFramesAreThoseOfTheParts) {
  PartFindings findings = Findings();
  findings.guessed = {{12, 22}};
  findings.breaks = {22};
  findings.pieces = {{0, 12}, {22, 30}};
  // The second shares its first four frames with the first.
  const FrameNames names{0, {{"sand", 0, 16}, {"rock", 4, 14}}};
  const Refusal dark = RefusalOf(Failing({"predicted"}, 1.0 / 3.0, 0.2), findings, names);
  EXPECT_THAT(dark.causes.at(0).found, HasSubstr("(12 of part sand to 9 of part rock)"));
  EXPECT_THAT(dark.causes[0].advice, HasSubstr("frames 0:12 of part sand is the longest run"));
  EXPECT_THAT(dark.usable, StartsWith("frames 0:12 of part sand and 10:18 of part rock"));
  const Refusal broken = RefusalOf(Failing({"breaks"}, 1.0, 0.0), findings, names);
  EXPECT_THAT(broken.causes.at(0).found, HasSubstr("begins at frame 10 of part rock"));
  EXPECT_THAT(broken.causes[0].advice, HasSubstr("(rigmap part --frames)"));
}

TEST(RefusalOf, OfFiguresThatHoldSaysHowGoodTheyAre) {
  Gates gates = Failing({"scale_95_pct", "position_95_pct"}, 1.218);
  gates.back().value = 1.54;
  const Refusal refusal = RefusalOf(gates, Findings());
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found,
              StartsWith("the scale is known to 1.2 % and the worst position to 80.0 cm, 1.5 % of "
                         "the path (95 %; asked was 1 %)"));
  EXPECT_EQ(refusal.usable,
            "shape and path: metres to 1.2 % and positions to 80.0 cm (95 %), if the baseline is "
            "537.17 mm");
  PartFindings corrected = Findings();
  corrected.rig_correction_px = 4.9;
  EXPECT_THAT(RefusalOf(gates, corrected).usable,
              testing::EndsWith("; the rig file was off by 4.9 px and has been corrected"));
  EXPECT_EQ(WarningOf(refusal), "not trusted: scale known to 1.2 %, asked 1 %");
  PartFindings nearly = Findings();
  nearly.accuracy.scale_95_pct = 1.04;
  EXPECT_EQ(HowGood(nearly), "1.04 % and positions to 80.0 cm (95 %)");
  // As of COLMAP's mapping alone.
  PartFindings without_positions = Findings();
  without_positions.accuracy.position_95_m.reset();
  EXPECT_THAT(
      RefusalOf(Failing({"scale_95_pct"}, 1.218), without_positions).usable,
      StartsWith("shape and path: metres to 1.2 % (95 %), of positions nothing is known, if"));
}

TEST(RefusalOf, AdvisesAgainstWhatTheUncertaintyComesFrom) {
  const auto advice = [](const PartFindings& findings) {
    return RefusalOf(Failing({"scale_95_pct"}), findings).causes.at(0).advice;
  };
  PartFindings findings = Findings();
  EXPECT_THAT(advice(findings), HasSubstr("rigmap calibrate"));
  findings.accuracy.noise_95_pct = 1.0;
  EXPECT_THAT(advice(findings), HasSubstr("a longer stretch"));
  findings.accuracy.baseline_95_pct = 1.1;
  EXPECT_THAT(advice(findings), HasSubstr("measure the baseline"));
  findings.breaks = {22};
  EXPECT_THAT(advice(findings), AllOf(HasSubstr("without gaps"), Not(HasSubstr("rig_refined"))));
  // Stereo matches are looked for in the rows that the rig file names: with one that was off by
  // more than they search, a corrected rig may close the gap.
  findings.rig_correction_px = 8.9;
  EXPECT_THAT(advice(findings), AllOf(HasSubstr("rig_refined.yaml"), HasSubstr("without gaps")));
  findings.rig_correction_px = 0.4;
  EXPECT_THAT(advice(findings), Not(HasSubstr("rig_refined")));
}

// Where nothing is torn no stretch is better than another.
TEST(RefusalOf, AMapThatDriftsLeavesNothing) {
  PartFindings findings = Findings();
  findings.guessed = {{0, 1}};
  findings.pieces = {{1, 30}};
  const Refusal refusal = RefusalOf(Failing({"motion_agreement_drift"}, 2.5), findings);
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found, HasSubstr("by 2.5 times what noise"));
  EXPECT_THAT(refusal.causes[0].advice, HasSubstr("--technique vo"));
  EXPECT_EQ(refusal.usable, "nothing");
}

TEST(RefusalOf, ADenseMapThatIsOffLeavesTheTrajectory) {
  const Refusal refusal = RefusalOf(Failing({"depth_bias_px"}, 0.3, 0.1), Findings());
  EXPECT_THAT(refusal.causes[0].found, HasSubstr("0.3 px of disparity (expected: at most 0.1 px)"));
  EXPECT_THAT(refusal.usable, StartsWith("shape and path, not the dense map: metres"));
}

TEST(RefusalOf, WhatIsNotANumberIsSaidToBeUnknown) {
  for (const auto& value : {std::optional<double>(), std::optional(std::nan("")),
                            std::optional(std::numeric_limits<double>::infinity())}) {
    Gates gates = Failing({"scale_95_pct"});
    gates.back().value = value;
    PartFindings findings = Findings();
    findings.accuracy.scale_95_pct.reset();
    const Refusal refusal = RefusalOf(gates, findings);
    EXPECT_THAT(refusal.causes[0].found, StartsWith("the scale is not known (95 %"));
    EXPECT_EQ(refusal.usable, "nothing");
  }
}

TEST(RefusalOf, AGateThatNobodyTellsOfIsToldAsItIs) {
  const Refusal refusal = RefusalOf(Failing({"new_gate"}), Findings());
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_EQ(SentenceOf(refusal.causes[0]), "too much: 1.5 (limit 1) (gate new_gate)");
  EXPECT_EQ(refusal.usable, "nothing");
}

TEST(RefusalOf, WhatWasJoinedHoldsWithoutThePartsThatAreMissing) {
  Gates gates = Failing({"parts_missing"}, 1.0, 0.0);
  gates.back().why = "part 2 could not be tied to part 1";
  const Refusal refusal = RefusalOf(gates, Findings());
  ASSERT_THAT(refusal.causes, SizeIs(1));
  EXPECT_THAT(refusal.causes[0].found, HasSubstr("part 2 could not be tied"));
  EXPECT_THAT(refusal.causes[0].advice, HasSubstr("--overlap"));
  EXPECT_THAT(refusal.usable, StartsWith("shape and path: metres to 1.2 %"));
}

}  // namespace
}  // namespace rigmap
