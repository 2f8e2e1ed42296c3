#include "workflows/calibrate.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "adjustment/calibration_prior.h"
#include "adjustment/pool_calibrations.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "dataset/rig_file.h"
#include "workflows/calibration_pool.h"
#include "workflows/rig_prior.h"

namespace rigmap {
namespace {

// What the parts say, as corrections of another rig than they were given.
std::vector<CalibrationWitness> WitnessesOf(const StereoRig& base,
                                            const std::vector<GivenPart>& parts) {
  std::vector<CalibrationWitness> witnesses;
  for (const GivenPart& part : parts) {
    const auto& [given, frames, correction, equations] = part.calibration;
    witnesses.push_back({CorrectionBetween(base, Corrected(given.rig, correction)), equations});
  }
  return witnesses;
}

[[noreturn]] void ThrowSingular() {
  throw DataError("expected parts that tell a calibration, found them singular");
}

// Each part's prior, should it be run again: the pool without it.
RigPool Contributions(const CalibrationPool& pool, const PooledCalibration& calibration,
                      const AdjustmentOptions& options) {
  RigPool contributions{pool.start, {}};
  for (const RigWithoutPart& part : pool.earlier) {
    const StereoRig without = RigWithout({pool.start, {}}, part);
    const auto found =
        PooledCorrection(WitnessesOf(without, pool.parts), PriorOf(without, options), options);
    if (!found) ThrowSingular();
    contributions.parts.push_back(
        {part.frames, CorrectionBetween(pool.start, Corrected(without, found->correction)),
         found->covariance + calibration.between});
  }
  for (std::size_t i = 0; i < pool.parts.size(); ++i) {
    const ProbableCorrection& without = calibration.parts[i].without;
    const bool has_others = pool.parts.size() > 1;
    contributions.parts.push_back(
        {pool.parts[i].calibration.frames,
         CorrectionBetween(pool.start, Corrected(pool.base, without.correction)),
         has_others ? without.covariance : pool.base.calibration_covariance});
  }
  return contributions;
}

std::string Table(const CalibrationPool& pool, const PooledCalibration& calibration,
                  const AdjustmentOptions& options) {
  const StereoRig pooled = Corrected(pool.base, calibration.pooled.correction);
  std::string table = fmt::format(
      "corrected: {}; largest shift in the right image {:.2f} px, disparity at infinity {:+.3f} "
      "px\n"
      "{:32} {:>16} {:>16} {:>9} {:>12} {:>9}\n",
      NameOf(calibration.refined), LargestShiftPx(pool.base, pooled),
      DisparityAtInfinity(pooled) - DisparityAtInfinity(pool.base), "part", "infinity px",
      "others px", "apart px", "difference", "largest");
  const CalibrationVector prior_sigmas = PriorOf(pool.base, options).sigmas;
  const auto infinity_px = [&](const ProbableCorrection& found) {
    const StereoRig rig = Corrected(pool.base, found.correction);
    return fmt::format(
        "{:+.3f} +- {:.3f}", DisparityAtInfinity(rig) - DisparityAtInfinity(pool.base),
        SigmaOf(DisparityAtInfinity, pool.base, found.correction, prior_sigmas, found.covariance));
  };
  for (std::size_t i = 0; i < pool.parts.size(); ++i) {
    const WitnessComparison& part = calibration.parts[i];
    table += fmt::format("{:32} {:>16} ", pool.parts[i].name, infinity_px(part.alone));
    table += pool.parts.size() > 1
                 ? fmt::format("{:>16} {:>9.2f} {:>12.2f} {:>9.2f}\n", infinity_px(part.others),
                               LargestShiftPx(Corrected(pool.base, part.others.correction),
                                              Corrected(pool.base, part.alone.correction)),
                               part.square_per_parameter, part.largest_sigmas)
                 : fmt::format("{:>16} {:>9} {:>12} {:>9}\n", "-", "-", "-", "-");
  }
  if (pool.parts.size() == 1) return table;
  return fmt::format(
      "{}apart: largest shift in the right image between what the part says and what all others "
      "do: the error that this part, left out, finds in them\n"
      "difference: square per parameter between the part and all others, in units of what both "
      "leave unknown; the same rig has about 1, chance makes up to {}, more is a rig that gives, "
      "above {} a part contradicts the others. largest: of the single parameters, in sigmas\n",
      table, kSquareByChance, kSameRigSquare);
}

// Parts that are not of one rig: it was knocked, warmed up or refocused, or one is of another.
void WarnOfContradictions(const CalibrationPool& pool, const PooledCalibration& calibration) {
  for (std::size_t i = 0; i < pool.parts.size(); ++i) {
    const double square = calibration.parts[i].square_per_parameter;
    if (pool.parts.size() == 1 || square <= kSameRigSquare) continue;
    spdlog::warn(
        "{} contradicts the others: it differs by {:.1f} squares per parameter (the same rig: at "
        "most {}); look whether all parts are of one rig, and calibrate without it",
        pool.parts[i].name, square, kSameRigSquare);
  }
}

// What a rig file says of where it comes from, for whoever opens it.
std::string Note(const std::vector<GivenPart>& parts) {
  std::string note;
  for (const GivenPart& part : parts) {
    if (part.contradiction.empty()) continue;
    spdlog::warn("{} is not trusted, and in the pool all the same: {}", part.name,
                 part.contradiction);
    note += fmt::format("# Not trusted, and in it all the same: {}: {}\n", part.name,
                        part.contradiction);
  }
  return note;
}

constexpr const char* kPooledMark = "# A rig as ";  // what such a file begins with

// Only what an earlier calibration has written may be replaced.
void RequireRigOut(const std::filesystem::path& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    throw DataError(fmt::format("{}: expected a folder for {}, found none", folder.string(),
                                path.filename().string()));
  }
  if (!std::filesystem::exists(path)) return;
  if (std::filesystem::is_directory(path)) {
    throw DataError(fmt::format("{}: expected a file to write to, found a folder", path.string()));
  }
  if (ReadBytes(path).starts_with(kPooledMark)) return;
  throw DataError(fmt::format(
      "{}: expected a rig file that rigmap calibrate has written, or none, found something else",
      path.string()));
}

std::string CalibrateNow(const CalibrateRequest& request) {
  RequireRigOut(request.rig_out);
  const CalibrationPool pool = ReadPool(request.outs);
  const AdjustmentOptions options = AdjustmentOptionsOf(request.outs);
  const auto calibration =
      PoolCalibrations(WitnessesOf(pool.base, pool.parts), PriorOf(pool.base, options), options);
  if (!calibration) ThrowSingular();
  PooledRig pooled{Corrected(pool.base, calibration->pooled.correction),
                   Contributions(pool, *calibration, options)};
  pooled.rig.calibration_covariance = calibration->pooled.covariance;
  const std::string note = Note(pool.parts);
  WriteFileAtomically(request.rig_out, [&](std::ostream& stream) {
    stream << fmt::format("{}{} parts tell it together.\n", kPooledMark, pooled.pool->parts.size())
           << note << WritePooledRigFile(pooled);
  });
  WarnOfContradictions(pool, *calibration);
  return Table(pool, *calibration, options);
}

}  // namespace

std::string Calibrate(const CalibrateRequest& request) {
  Job job(1, false);  // messages go to standard error
  return job.Run([&] { return CalibrateNow(request); });
}

}  // namespace rigmap
