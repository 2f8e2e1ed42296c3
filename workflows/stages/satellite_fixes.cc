#include "workflows/stages/satellite_fixes.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/error.h"
#include "core/stamp_steps.h"
#include "core/statistics.h"
#include "gates/accuracy.h"
#include "georeference/fix_judgement.h"
#include "georeference/local_frame.h"
#include "pipeline/code_identity.h"
#include "pose_graph/fuse_fixes.h"
#include "trajectory/adjusted_steps.h"
#include "workflows/stages/fix_clocks.h"
#include "workflows/stages/fix_stretches.h"

namespace rigmap {
namespace {

constexpr double kFewestSigmas = 2.0;  // that the judges gain

class FixTie {
 public:
  FixTie(const AdjustedPart& part, const StereoRig& rig, const JoinedParts& parts,
         const SplitFixes& fixes, const RtkAlignmentOptions& options)
      : part_(part),
        rig_(rig),
        fixes_(fixes),
        parts_(parts),
        antenna_(*rig.antenna_in_left),
        options_(options),
        whole_(AlignToRtk(fixes.tying, part.trajectory, antenna_, options)),
        clocks_(part.trajectory, parts, fixes.tying, antenna_, options) {
    ReportInput();
  }

  TiedPart Tie() {
    TiedPart result{part_, ""};
    if (!whole_.alignment) return NotUsed(std::move(result), whole_.why);
    const auto fused =
        FuseFixes(part_.trajectory, InEnu(fixes_.tying, *whole_.alignment, clocks_), Fusion());
    if (!fused) {
      return NotUsed(std::move(result),
                     "no path of the images was found that two thirds of the fixes agree with");
    }
    Describe(*fused);
    const Trajectory moved = Moved(*fused);
    const RtkFit laid = AlignToRtk(fixes_.tying, moved, antenna_, options_);
    if (!laid.alignment) return NotUsed(std::move(result), laid.why);
    const auto judged = Judge(moved, *laid.alignment);
    if (!judged) {
      return NotUsed(std::move(result),
                     fmt::format("of the fixes held back, {}, fewer than four lie beside the path: "
                                 "nothing would check what the others do to it",
                                 fixes_.judging.size()));
    }
    report_["judging_rms_before_m"] = judged->first_m;
    report_["judging_rms_after_m"] = judged->second_m;
    report_["judging_gain_sigmas"] = judged->gain_sigmas;
    if (judged->gain_sigmas <= kFewestSigmas) {
      return NotUsed(
          std::move(result),
          fmt::format("the fixes held back would agree with the path to {:.4f} m instead of {:.4f} "
                      "m{}",
                      judged->second_m, judged->first_m,
                      judged->gain_sigmas > 0.0 ? ", which may be chance" : ""));
    }
    Move(*fused, result.part);
    report_["used"] = true;
    report_["why_not"] = nullptr;
    result.report = report_.dump();
    return result;
  }

 private:
  void ReportInput() {
    const auto is_float = [](const GnssFix& fix) { return fix.status != kRtkFixed; };
    report_["tying"] = fixes_.tying.size();
    report_["judging"] = fixes_.judging.size();
    report_["split"] = "by turns of ten seconds with fixes: the even ones tie, the odd ones judge";
    report_["not_rtk_fixed"] = std::ranges::count_if(fixes_.tying, is_float);
    std::vector<StampNs> stamps = StampsOfFixed(fixes_.tying);
    std::ranges::move(StampsOfFixed(fixes_.judging), std::back_inserter(stamps));
    std::ranges::sort(stamps);
    report_["gaps"] = GapsBetween(stamps);
    report_["clocks"] = clocks_.Describe();
  }

  std::vector<AntennaFix> InEnu(const std::vector<GnssFix>& fixes, const RtkAlignment& alignment,
                                const FixClocks& clocks) const {
    const LocalFrame frame(alignment.plane_origin);
    std::vector<AntennaFix> result;
    for (const GnssFix& fix : fixes) {
      if (fix.status != kRtkFixed) continue;
      const double time_s = SecondsBetween(part_.trajectory.front().stamp_ns, fix.stamp_ns) -
                            clocks.OffsetAt(fix.stamp_ns, alignment.clock_offset_s);
      constexpr double kMinSigma_m = 0.001;
      result.push_back({time_s, frame.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m}),
                        fix.sigma_enu_m.cwiseMax(kMinSigma_m)});
    }
    return result;
  }

  // The horizontal alignment, and the height that most fixes agree with.
  Rigid3 EnuFromWorld() const {
    const Rigid2& plane = whole_.alignment->plane_from_world;
    Rigid3 enu_from_world{
        Eigen::Quaterniond(Eigen::AngleAxisd(plane.angle_rad, Eigen::Vector3d::UnitZ())),
        {plane.translation.x(), plane.translation.y(), 0.0}};
    std::vector<double> heights;
    for (const AntennaFix& fix : InEnu(fixes_.tying, *whole_.alignment, clocks_)) {
      const auto antenna = AntennaAt(part_.trajectory, fix.time_s, antenna_, options_.max_gap_s);
      if (antenna) heights.push_back(fix.x_in_enu.z() - antenna->z());
    }
    if (!heights.empty()) enu_from_world.translation.z() = Median(std::move(heights));
    return enu_from_world;
  }

  // Of the length of the path, as the verdict states it; nothing is known of a path without one.
  double ScaleSigma() const {
    constexpr double kPerCentAt95 = 100.0 * 1.960;
    return AccuracyOf(part_.trajectory, part_.adjustment, rig_).scale_95_pct.value_or(0.0) /
           kPerCentAt95;
  }

  // A step that wheels or a few points on the horizon bridge is not as good as the others.
  FixFusion Fusion() const {
    FixFusion fusion{antenna_,           EnuFromWorld(),
                     ScaleSigma(),       whole_.alignment->clock_offset_sigma_s,
                     options_.max_gap_s, AdjustedSteps(part_.odometry, part_.adjustment)};
    for (std::size_t i = 0; i < fusion.step_covariances.size(); ++i) {
      const OdometryFrame& frame = part_.odometry[i];
      auto& known = fusion.step_covariances[i];
      if (!known && frame.source == PoseSource::kOdometry) known = frame.step_covariance;
    }
    return fusion;
  }

  // Horizontal offsets of a path from the judging fixes, laid on the tying ones; nothing for those
  // beside no pose.
  std::vector<std::optional<Eigen::Vector2d>> OffsetsFromJudges(const Trajectory& poses,
                                                                const RtkAlignment& alignment,
                                                                const FixClocks& clocks) const {
    std::vector<std::optional<Eigen::Vector2d>> offsets;
    for (const AntennaFix& fix : InEnu(fixes_.judging, alignment, clocks)) {
      const auto antenna = AntennaAt(poses, fix.time_s, antenna_, options_.max_gap_s);
      auto& offset = offsets.emplace_back();
      if (!antenna) continue;
      offset =
          alignment.plane_from_world * Eigen::Vector2d(antenna->head<2>()) - fix.x_in_enu.head<2>();
    }
    return offsets;
  }

  // Both paths are laid on the tying fixes in the same way, their clocks found by themselves, so
  // that nothing but their shape is judged.
  std::optional<FixJudgement> Judge(const Trajectory& moved, const RtkAlignment& laid) const {
    const FixClocks clocks(moved, parts_, fixes_.tying, antenna_, options_);
    const auto before = OffsetsFromJudges(part_.trajectory, *whole_.alignment, clocks_);
    const auto after = OffsetsFromJudges(moved, laid, clocks);
    const std::vector<AntennaFix> fixes = InEnu(fixes_.judging, laid, clocks);
    const std::vector<StampNs> stamps = StampsOfFixed(fixes_.judging);  // of these
    std::vector<FixBesideTwoPaths> judges;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      if (!before[i] || !after[i]) continue;
      judges.push_back(
          {*before[i], *after[i], fixes[i].sigma_m.head<2>().maxCoeff(), TurnOf(stamps[i])});
    }
    return JudgeByFixes(judges);
  }

  Trajectory Moved(const FusedFixes& fused) const {
    Trajectory moved = part_.trajectory;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].world_from_left = fused.world_from_left[i];
    }
    return moved;
  }

  void Describe(const FusedFixes& fused) {
    report_["believed"] = std::ranges::count(fused.used, 1);
    report_["not_believed"] = std::ranges::count(fused.used, 0);
    report_["not_believed_spans"] = StretchesNotUsed(StampsOfFixed(fixes_.tying), fused.used);
    report_["scale_correction_pct"] = 100.0 * (fused.scale - 1.0);
    report_["clock_offset_s"] = whole_.alignment->clock_offset_s + fused.clock_offset_s;
    report_["fix_noise_factor"] = fused.fix_noise_factor;
    report_["chi2_per_degree"] = fused.chi2 / std::max(1, fused.degrees_of_freedom);
    // The mean of a chi-square over its degrees is one, its deviation this; three of them.
    const double limit = 1.0 + 3.0 * std::sqrt(2.0 / std::max(1, fused.degrees_of_freedom));
    report_["chi2_per_degree_limit"] = limit;
    const double as_stated = fused.chi2_as_stated / std::max(1, fused.degrees_of_freedom);
    report_["chi2_per_degree_as_stated"] = as_stated;
    report_["consistent"] = as_stated <= limit;
    report_["remark"] = nullptr;
    if (as_stated <= limit) return;
    const std::string remark = fmt::format(
        "path and fixes contradict each other by {:.2g} times their stated sigmas (at most {:.2g} "
        "is chance)",
        std::sqrt(as_stated), std::sqrt(limit));
    spdlog::warn("--use-rtk: {}", remark);
    report_["remark"] = remark;
  }

  TiedPart NotUsed(TiedPart result, std::string why) {
    const std::string exchanged =
        FitOnlyExchanged(fixes_.tying, part_.trajectory, antenna_, options_);
    if (!exchanged.empty()) why += "; " + exchanged;
    spdlog::warn("--use-rtk: the poses are left as the images tell them: {}", why);
    report_["used"] = false;
    report_["why_not"] = why;
    result.report = report_.dump();
    return result;
  }

  void Move(const FusedFixes& fused, AdjustedPart& moved) const {
    const Rigid3& world_from_gauge = part_.world_from_gauge;
    std::vector<Rigid3> corrections;  // of what the frame shows, in the gauge
    for (std::size_t i = 0; i < fused.world_from_left.size(); ++i) {
      const Rigid3& before = part_.trajectory[i].world_from_left;
      const Rigid3& after = fused.world_from_left[i];
      moved.trajectory[i].world_from_left = after;
      corrections.push_back(world_from_gauge.Inverse() * after * before.Inverse() *
                            world_from_gauge);
      if (auto& pose = moved.adjustment.world_from_left[i]) pose = corrections.back() * *pose;
    }
    for (AdjustedPoint& point : moved.adjustment.points) {
      point.x = corrections[static_cast<std::size_t>(point.observations.front().frame)] * point.x;
    }
  }

  const AdjustedPart& part_;
  const StereoRig& rig_;
  const SplitFixes& fixes_;
  const JoinedParts& parts_;
  Eigen::Vector3d antenna_;
  const RtkAlignmentOptions& options_;
  RtkFit whole_;
  FixClocks clocks_;
  Report report_ = Report::object();
};

TiedPart MakeTied(const StageContext&, const Dataset& dataset, const AdjustedPart& part,
                  const JoinedParts& parts, const SplitFixes& fixes,
                  const RtkAlignmentOptions& options) {
  RequireFixes(dataset.rig.source, dataset.rig.antenna_in_left.has_value(),
               fixes.tying.size() + fixes.judging.size());
  return FixTie(part, dataset.rig, parts, fixes, options).Tie();
}

void PublishTied(Publication& publication, const StageContext&, const TiedPart& tied,
                 const Dataset& dataset, const AdjustedPart&, const JoinedParts&,
                 const SplitFixes&) {
  PublishPosesAndPoints(tied.part, dataset, publication);
}

Report ReportTied(const TiedPart& tied, const Dataset&, const AdjustedPart&, const JoinedParts&,
                  const SplitFixes&) {
  return {{"rtk_use", Report::parse(tied.report)}};
}

}  // namespace

void RequireFixes(const std::string& rig_source, bool has_antenna, std::size_t fixes) {
  if (!has_antenna) {
    throw DataError(fmt::format(
        "{}: --use-rtk: expected the antenna's place (antenna_in_left), found none", rig_source));
  }
  if (fixes == 0) {
    throw DataError("--use-rtk: expected satellite fixes beside the images, found none");
  }
}

RtkStage TieToFixes() {
  return {.name = "rtk",
          .about = "poses tied to satellite fixes",
          .code = CodeHere(),
          .make = MakeTied,
          .publishes = PosesAndPointsOutputs(),
          .publish = PublishTied,
          .report = ReportTied};
}

AdjustedPart PartOf(const StageContext&, const TiedPart& tied) { return tied.part; }

}  // namespace rigmap
