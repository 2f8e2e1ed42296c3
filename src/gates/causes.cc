#include "gates/internal/causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "gates/internal/advice.h"

namespace rigmap {
namespace {

constexpr std::string_view kThisRig =
    "check that the rig file is of these cameras at this image size, left and right not exchanged; "
    "else calibrate them anew and give that file with --rig";
constexpr std::string_view kOverlap =
    "cut the parts so that they share frames (--overlap), or bridge the gap by images of the same "
    "ground; else take each world for itself";

std::string SameMoment(const Failed& failed) {
  return fmt::format(
      "check that left and right images are of the same moment and sharp, and that not everything "
      "in view moves; a slower stretch ({}) shows whether motion is the reason",
      failed.ToTakeFrames());
}

// Stretches to be taken, each as its own part.
std::string Alone(const Failed& failed, std::span<const FrameRun> stretches) {
  const FrameNames& names = failed.names();
  std::vector<std::string> texts;
  for (const FrameRun& stretch : stretches) texts.push_back(names.Of(stretch));
  if (names.parts.empty()) return fmt::format("--frames {}", fmt::join(texts, ", --frames "));
  return fmt::format("frames {}", fmt::join(texts, ", "));
}

}  // namespace

Cause RigDoesNotFit(const Failed& failed) {
  const Gate& gate = *failed.Find("epipolar_px");
  return {"left and right images do not fit the rig file",
          fmt::format("left and right images do not fit the rig file: half of the points lie {} px "
                      "and more beside the line on which it has them (expected: at most {} px)",
                      ValueText(gate), LimitText(gate)),
          fmt::format("check that left and right images are of the same moment, not out of step by "
                      "a pair; {}",
                      kThisRig)};
}

Cause NothingToFollow(const Failed& failed) {
  const Gate& gate = *failed.Find("predicted");
  const PartFindings& findings = failed.findings();
  constexpr std::size_t kMostRanges = 4;
  std::vector<std::string> ranges;
  for (const FrameRun& range : findings.guessed) ranges.push_back(failed.names().Of(range));
  if (ranges.size() > kMostRanges) {
    ranges.resize(kMostRanges);
    ranges.emplace_back("...");
  }
  const auto rest = findings.LongestMeasured();
  return {
      fmt::format("{} of {} poses are guessed", findings.GuessedCount(), findings.frames),
      fmt::format("{} of {} frames ({}) show nothing that could be followed, so that their poses "
                  "are guessed (expected: at most {} %)",
                  findings.GuessedCount(), findings.frames, fmt::join(ranges, ", "),
                  LimitText(gate, 100.0)),
      fmt::format(
          "look at these images: black, blinded, blurred, or too far from one to the "
          "next to have anything in common{}",
          rest ? fmt::format("; {} is the longest run without them", Alone(failed, {&*rest, 1}))
               : "")};
}

Cause WayIsBroken(const Failed& failed) {
  constexpr std::size_t kMostFrames = 4;
  const auto& breaks = failed.findings().breaks;
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < std::min(breaks.size(), kMostFrames); ++i) {
    frames.push_back(failed.names().Of(breaks[i]));
  }
  if (breaks.size() > kMostFrames) frames.emplace_back("...");
  return {"the way is broken: part of it is guessed",
          fmt::format("the way is broken: nothing measured joins what begins at frame {} to what "
                      "was before, so that it lies where it was guessed (expected: frame after "
                      "frame, or a place seen again)",
                      fmt::join(frames, ", ")),
          AdviceOnGaps(failed)};
}

Cause RigIsContradicted(const Failed& failed) {
  if (const Gate* gate = failed.Find("rig_refinement_px")) {
    return {"the images contradict the rig file",
            fmt::format("the images contradict the rig file: they would have it moved by {} px in "
                        "the right image (a calibration errs by {} px at most)",
                        ValueText(*gate), LimitText(*gate)),
            std::string(kThisRig)};
  }
  const std::string advice = fmt::format("calibrate the rig anew, or {}", kManyDrives);
  if (const Gate* gate = failed.Find("infinity_offset_px")) {
    return {
        "the images contradict the rig file",
        fmt::format("depths are off: the images would change the disparity at infinity by {} px "
                    "(expected: at most {})",
                    ValueText(*gate), LimitText(*gate)),
        advice};
  }
  if (const Gate* gate = failed.Find("rig_consistency_deg")) {
    return {"the images contradict the rig file",
            fmt::format("depths are off: the images would turn the right camera by {} degrees "
                        "(expected: at most {})",
                        ValueText(*gate), LimitText(*gate)),
            advice};
  }
  if (const Gate* gate = failed.Find("intrinsics_consistency_pct")) {
    return {"the images contradict the rig file's focal lengths",
            fmt::format("depths are off: the images would change the focal lengths by {} % "
                        "(expected: at most {} %)",
                        ValueText(*gate), LimitText(*gate)),
            advice};
  }
  return {"the images contradict the rig file",
          "depths are off: the images contradict the rig file by far more than its sigmas "
          "(expected: a few)",
          advice};
}

Cause FewRegistered(const Failed& failed) {
  const Gate& gate = *failed.Find("registered");
  const std::string share = ValueText(gate, 100.0);
  return {fmt::format("only {} % of the keyframes are in the map", share),
          fmt::format("only {} % of the keyframes found a way into the map (expected: at least "
                      "{} %)",
                      share, LimitText(gate, 100.0)),
          fmt::format(
              "take images that have more in common: more of them on the same way, or a stretch "
              "without glare, blur and quick turns ({})",
              failed.ToTakeFrames())};
}

Cause MapIsBent(const Failed& failed) {
  if (const Gate* gate = failed.Find("baseline_spread")) {
    return {"the map is bent or torn",
            fmt::format("the map is bent or torn: its left-right distances, which are all the same "
                        "on the rig, differ by {} % (expected: at most {} %)",
                        ValueText(*gate, 100.0), LimitText(*gate, 100.0)),
            SameMoment(failed)};
  }
  const Gate& gate = *failed.Find("baseline_rejected");
  return {"the map is bent or torn",
          fmt::format("the map is bent or torn: {} % of its left-right distances do not fit the "
                      "others (expected: at most {} %)",
                      ValueText(gate, 100.0), LimitText(gate, 100.0)),
          SameMoment(failed)};
}

Cause MatchesContradict(const Failed& failed) {
  const Gate* dropped = failed.Find("outlier_share");
  const Gate* apart = failed.Find("reprojection_px");
  std::string found = "the matches contradict each other:";
  if (dropped) {
    found += fmt::format(" {} % had to be dropped (expected: at most {} %)",
                         ValueText(*dropped, 100.0), LimitText(*dropped, 100.0));
  }
  if (apart) {
    found += fmt::format(
        "{} half of the points lie {} px and more beside where they were seen "
        "(expected: at most {} px)",
        dropped ? "," : "", ValueText(*apart), LimitText(*apart));
  }
  return {"the matches contradict each other", std::move(found), SameMoment(failed)};
}

Cause MotionsDiffer(const Failed& failed) {
  const Gate* pct = failed.Find("motion_agreement_pct");
  std::string found =
      pct ? fmt::format(
                "map and odometry tell of different motions: a tenth of the steps differ by "
                "{} % of their length and more (expected: at most {} %)",
                ValueText(*pct), LimitText(*pct))
          : "map and odometry tell of different motions over three steps, or far in one (expected: "
            "never)";
  std::string advice = SameMoment(failed);
  if (failed.IsInPieces()) {
    constexpr std::size_t kMostPieces = 2;
    const std::span<const FrameRun> pieces = failed.findings().pieces;
    advice = fmt::format("reconstruct each stretch on which they agree by itself: {}",
                         Alone(failed, pieces.first(std::min(pieces.size(), kMostPieces))));
  }
  return {"map and odometry tell of different motions", std::move(found), std::move(advice)};
}

Cause MotionsDrift(const Failed& failed) {
  const Gate& gate = *failed.Find("motion_agreement_drift");
  return {"map and odometry drift apart",
          fmt::format("map and odometry drift apart, by little in each step: over many by {} times "
                      "what noise and the accuracy asked for explain (expected: at most {})",
                      ValueText(gate), LimitText(gate)),
          "compare both (--technique vo) with a distance that is known: one of them is wrong"};
}

Cause SensorsContradict(const Failed& failed) {
  const Gate& gate = *failed.Find("sensors_contradict");
  return {
      "images and wheels tell of different motions",
      fmt::format("images and wheels tell of different motions in {} % of the steps (expected: "
                  "at most {} %)",
                  ValueText(gate, 100.0), LimitText(gate, 100.0)),
      "look at the images of the frames that the gate names in summary.json: does something move "
      "along with the rover, or do they not move on; compare --technique vo with wheels; look at "
      "units and columns of the wheels' "
      "file, or do without what is wrong: --set filter.use_wheels=false, filter.use_gyro=false"};
}

Cause CloudsSlide(const Failed& failed) {
  const Gate& gate = *failed.Find("unheld");
  return {"the surface does not hold the clouds",
          fmt::format("{} % of the clouds could slide on their surface, which is too smooth or too "
                      "little known to hold them (expected: at most {} %)",
                      ValueText(gate, 100.0), LimitText(gate, 100.0)),
          "let --technique rig or vo follow what is drawn on the surface, or take images in which "
          "more stands up from it"};
}

Cause ChainsDiffer(const Failed& failed) {
  const Gate* pct = failed.Find("closure_pct");
  return {
      "registrations contradict each other",
      fmt::format("registrations contradict each other: over two steps, chained and direct "
                  "motion differ by {} and more for a tenth of the frames (expected: less)",
                  pct ? ValueText(*pct) + " % of the way"
                      : ValueText(*failed.Find("closure_sigmas")) + " sigmas"),
      "let the improved way of registration do what the plain one does not (docs/options.md), or "
      "--technique rig, which also follows what is drawn on the surface"};
}

Cause LengthsDiffer(const Failed& failed) {
  const Gate& gate = *failed.Find("length_pct");
  return {"poses and odometry tell of ways of different length",
          fmt::format("poses and odometry tell of ways of different length: by {} % (expected: at "
                      "most {} %)",
                      ValueText(gate), LimitText(gate)),
          "let --technique rig, which holds every frame to the rig and lets the images correct it, "
          "tell which is right"};
}

Cause DepthsDisagree(const Failed& failed) {
  const Gate& gate = *failed.Find("depth_consistency_pct");
  return {"stereo and motion tell of different depths",
          fmt::format("stereo and motion tell of different depths: from one part of the image to "
                      "another they differ by {} % (expected: at most {} %), as lenses do that the "
                      "rig file has wrong",
                      ValueText(gate), LimitText(gate)),
          fmt::format("calibrate the lenses anew, or {}", kManyDrives)};
}

Cause DenseDiffers(const Failed& failed) {
  const Gate& gate = *failed.Find("depth_bias_px");
  return {"dense depth and sparse points differ",
          fmt::format("dense depth and sparse points differ by {} px of disparity (expected: at "
                      "most {} px)",
                      ValueText(gate), LimitText(gate)),
          "look whether left and right images are equally bright and sharp, and whether the ground "
          "shows any texture"};
}

Cause PartsLieApart(const Failed& failed) {
  return {"some parts are tied to the others by nothing", failed.Find("worlds")->why,
          std::string(kOverlap)};
}

Cause PartsAreMissing(const Failed& failed) {
  return {"not all parts are in it", failed.Find("parts_missing")->why, std::string(kOverlap)};
}

}  // namespace rigmap
