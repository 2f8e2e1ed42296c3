#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gates/internal/advice.h"
#include "gates/internal/causes.h"

namespace rigmap {
namespace {

// What the uncertainty comes from, and what helps against it.
struct Origin {
  std::string about, advice;
};

Origin OriginOf(const Failed& failed) {
  const Accuracy& accuracy = failed.findings().accuracy;
  const auto share = [&](const std::optional<double>& part) {
    if (!part || !accuracy.scale_95_pct) return 0.0;
    return *part * *part / (*accuracy.scale_95_pct * *accuracy.scale_95_pct);
  };
  constexpr double kMost = 0.5;  // of the variance
  if (!failed.findings().breaks.empty()) {
    return {"part of the way is guessed", AdviceOnGaps(failed)};
  }
  if (!accuracy.noise_95_pct && !failed.findings().bridged.empty()) {
    return {"most of it is of steps that only wheels and gyro tell", AdviceOnGaps(failed)};
  }
  if (!accuracy.noise_95_pct) {
    return {
        "the errors of single steps add up",
        "take more images on the same way, so that neighbours share more; --technique rig adjusts "
        "together what shares points"};
  }
  if (share(accuracy.baseline_95_pct) > kMost) {
    return {"most of it is what the rig file says its baseline may be off by",
            "measure the baseline more exactly, and say so in the rig file (sigmas: baseline_m)"};
  }
  if (share(accuracy.noise_95_pct) > kMost) {
    return {"most of it is noise of the images",
            "take a longer stretch, more images on the same way, or nearer ground"};
  }
  return {"most of it is what is not known of the rig's calibration", std::string(kManyDrives)};
}

}  // namespace

std::string AdviceOnGaps(const Failed& failed) {
  constexpr double kMissesMatches_px = 1.0;  // of the rows that stereo matches are looked for in
  const bool was_off = failed.findings().rig_correction_px.value_or(0.0) > kMissesMatches_px;
  const std::string without =
      fmt::format("take a stretch without gaps ({})", failed.ToTakeFrames());
  if (!was_off) return without;
  return "run it again with --rig and the rig_refined.yaml of this result: with the rig file as it "
         "was, stereo matches were missed; else " +
         without;
}

Cause NotAsGoodAsAsked(const Failed& failed) {
  const Gate* scale = failed.Find("scale_95_pct");
  const Gate* position = failed.Find("position_95_pct");
  const Accuracy& accuracy = failed.findings().accuracy;
  const std::string asked = fmt::format("{:.2g} %", failed.findings().accuracy_asked_pct);
  std::vector<std::string> known;
  if (scale) {
    known.push_back(scale->value ? fmt::format("the scale is known to {} %", ValueText(*scale))
                                 : "the scale is not known");
  }
  if (position && position->value && accuracy.position_95_m) {
    known.push_back(fmt::format("the worst position {}to {}, {} % of {}", scale ? "" : "is known ",
                                LengthText(*accuracy.position_95_m), ValueText(*position),
                                accuracy.path_m < 1.0 ? "a metre" : "the path"));
  } else if (position) {
    known.push_back("positions are not known");
  }
  const Origin origin = OriginOf(failed);
  const std::string brief =
      scale ? (scale->value ? fmt::format("scale known to {} %, asked {}", ValueText(*scale), asked)
                            : "scale not known")
      : position->value ? fmt::format("positions known to {} % of the path, asked {}",
                                      ValueText(*position), asked)
                        : "positions not known";
  return {
      brief,
      fmt::format("{} (95 %; asked was {}); {}", fmt::join(known, " and "), asked, origin.about),
      origin.advice};
}

}  // namespace rigmap
