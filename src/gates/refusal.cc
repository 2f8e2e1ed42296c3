#include "gates/refusal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "gates/internal/causes.h"

namespace rigmap {
namespace {

// A cause, the gates that speak of it, and those that then merely follow.
struct Root {
  Cause (*tell)(const Failed&);
  std::vector<std::string_view> gates, follow;
  bool leaves_pieces = false;  // what was measured holds between the gaps
  bool leaves_path = false;    // the trajectory holds, as well as its sigmas say
};

std::vector<std::string_view> Joined(std::initializer_list<std::vector<std::string_view>> lists) {
  std::vector<std::string_view> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

// In the order of the stages, but for the rig, which all of them use.
const std::vector<Root>& Roots() {
  using Names = std::vector<std::string_view>;
  static const Names sigmas{"scale_95_pct", "position_95_pct"};
  static const Names steps{"motion_agreement_window", "motion_agreement_sigmas",
                           "motion_agreement_pct"};
  static const Names drift{"motion_agreement_drift"};
  static const Names motion = Joined({steps, drift});
  static const Names residuals{"reprojection_px", "outlier_share"};
  static const Names shape{"baseline_spread", "baseline_rejected"};
  static const Names rig{"rig_refinement_px",          "infinity_offset_px",
                         "rig_consistency_deg",        "rig_consistency_sigmas",
                         "intrinsics_consistency_pct", "intrinsics_consistency_sigmas"};
  static const Names registered{"registered"}, dark{"predicted"}, broken{"breaks"},
      depth{"depth_bias_px"}, lenses{"depth_consistency_pct"};
  static const Names closure{"closure_sigmas", "closure_pct"}, length{"length_pct"};
  static const Names clouds = Joined({{"unheld"}, closure, length});
  static const std::vector<Root> roots{
      {RigDoesNotFit,
       {"epipolar_px"},
       Joined({dark, broken, rig, registered, shape, residuals, clouds, motion, lenses, sigmas,
               depth})},
      {SensorsContradict, {"sensors_contradict"}, Joined({motion, sigmas})},
      {CloudsSlide, {"unheld"}, Joined({dark, broken, closure, length, motion, sigmas})},
      {NothingToFollow, dark, Joined({broken, registered, sigmas}), true},
      {WayIsBroken, broken, Joined({registered, sigmas}), true},
      {RigIsContradicted, rig,
       Joined({registered, shape, residuals, clouds, motion, lenses, sigmas, depth})},
      {ChainsDiffer, closure, Joined({length, motion, sigmas})},
      {FewRegistered, registered, Joined({shape, length, motion, sigmas})},
      {MapIsBent, shape, Joined({length, motion, lenses, sigmas})},
      {MatchesContradict, residuals, Joined({motion, lenses, sigmas})},
      {MotionsDiffer, steps, Joined({drift, length, lenses, sigmas}), true},
      {MotionsDrift, drift, Joined({length, lenses, sigmas})},
      {LengthsDiffer, length, sigmas},
      {DepthsDisagree, lenses, sigmas},
      {NotAsGoodAsAsked, sigmas, {}, false, true},
      {DenseDiffers, depth, {}, false, true},
      {PartsLieApart, {"worlds"}, {"parts_missing"}, true},
      {PartsAreMissing, {"parts_missing"}, {}, false, true}};
  return roots;
}

// How good what was measured is, by its own sigmas.
std::string AccuracyText(const PartFindings& findings) {
  const Accuracy& accuracy = findings.accuracy;
  const std::string correction =
      findings.rig_correction_px
          ? fmt::format("; the rig file was off by {:.2g} px and has been corrected",
                        *findings.rig_correction_px)
          : "";
  const std::string how_good = fmt::format("metres to {}", HowGood(findings));
  if (findings.baseline_m == 0.0) return how_good;
  return fmt::format("{}, if the baseline is {:.2f} mm{}{}", how_good, 1000.0 * findings.baseline_m,
                     accuracy.baseline_95_pct ? " to the sigma that the rig file states" : "",
                     correction);
}

std::string Usable(const Failed& failed, const std::vector<const Root*>& roots) {
  const PartFindings& findings = failed.findings();
  const bool path_holds = std::ranges::all_of(roots, &Root::leaves_path);
  const bool pieces_hold = std::ranges::all_of(
      roots, [](const Root* root) { return root->leaves_pieces || root->leaves_path; });
  if (!pieces_hold) return "nothing";
  if (!path_holds && failed.IsInPieces()) {
    constexpr std::size_t kMostPieces = 3;
    std::vector<std::string> ranges;
    for (const FrameRun& piece : findings.pieces) {
      if (ranges.size() < kMostPieces) ranges.push_back(failed.names().Of(piece));
    }
    return fmt::format(
        "frames {}, each by itself in one piece; how good, a run of it alone will say",
        fmt::join(ranges, " and "));
  }
  const Accuracy& accuracy = findings.accuracy;
  // Gaps that measurements bridge leave all but themselves.
  const bool is_joined = path_holds || (!findings.guessed.empty() && !findings.pieces.empty());
  const bool are_metres_known = accuracy.scale_95_pct && std::isfinite(*accuracy.scale_95_pct);
  if (!is_joined || !are_metres_known) return "nothing";
  return fmt::format("{}{}: {}", path_holds ? "shape and path" : "all poses but the guessed ones",
                     failed.Find("depth_bias_px") ? ", not the dense map" : "",
                     AccuracyText(findings));
}

// Gates that no cause speaks of.
Cause Other(const Gate& gate) {
  return {gate.why,
          fmt::format("{}: {} (limit {})", gate.why, gate.value ? ValueText(gate) : "not a number",
                      LimitText(gate)),
          "see what docs/gates.md says of it",
          {gate}};
}

}  // namespace

Refusal RefusalOf(const Gates& gates, const PartFindings& findings, const FrameNames& names) {
  const Failed failed(gates, findings, names);
  Refusal refusal;
  std::vector<const Root*> told;
  std::vector<std::string_view> explained;
  const auto is_explained = [&](const Gate& gate) {
    return std::ranges::find(explained, gate.name) != explained.end();
  };
  for (const Root& root : Roots()) {
    Gates speaking;
    for (const Gate& gate : failed.gates()) {
      const bool is_own = std::ranges::find(root.gates, gate.name) != root.gates.end();
      if (is_own && !is_explained(gate)) speaking.push_back(gate);
    }
    if (speaking.empty()) continue;
    Cause cause = root.tell(failed);
    cause.gates = std::move(speaking);
    refusal.causes.push_back(std::move(cause));
    told.push_back(&root);
    explained.insert(explained.end(), root.gates.begin(), root.gates.end());
    explained.insert(explained.end(), root.follow.begin(), root.follow.end());
  }
  for (const Gate& gate : failed.gates()) {
    if (!is_explained(gate)) refusal.causes.push_back(Other(gate));
  }
  const bool all_told = told.size() == refusal.causes.size();
  if (!refusal.causes.empty()) refusal.usable = all_told ? Usable(failed, told) : "nothing";
  return refusal;
}

std::string SentenceOf(const Cause& cause) {
  std::vector<std::string> names;
  for (const Gate& gate : cause.gates) names.push_back("gate " + gate.name);
  return fmt::format("{} ({})", cause.found, fmt::join(names, ", "));
}

std::string WarningOf(const Refusal& refusal) {
  if (refusal.causes.empty()) return "";
  const std::size_t more = refusal.causes.size() - 1;
  return fmt::format("not trusted: {}{}", refusal.causes.front().brief,
                     more > 0 ? fmt::format("; {} more", more) : "");
}

std::string HowGood(const PartFindings& findings) {
  const Accuracy& accuracy = findings.accuracy;
  const std::string scale =
      ValueText({.value = *accuracy.scale_95_pct, .limit = findings.accuracy_asked_pct});
  if (!accuracy.position_95_m) {
    return fmt::format("{} % (95 %), of positions nothing is known", scale);
  }
  return fmt::format("{} % and positions to {} (95 %)", scale, LengthText(*accuracy.position_95_m));
}

std::string LengthText(double metres) {
  return metres < 0.01  ? fmt::format("{:.1f} mm", 1000.0 * metres)
         : metres < 1.0 ? fmt::format("{:.1f} cm", 100.0 * metres)
                        : fmt::format("{:.2f} m", metres);
}

}  // namespace rigmap
