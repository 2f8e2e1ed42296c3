#include "workflows/calibrate.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "adjustment/calibration_prior.h"
#include "adjustment/pool_calibrations.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "dataset/rig_file.h"
#include "workflows/part_options.h"
#include "workflows/rig_prior.h"
#include "workflows/stages/calibration_output.h"

namespace rigmap {
namespace {

struct GivenPart {
  std::string name;
  PartCalibration calibration;
};

struct Pool {
  StereoRig start;  // before any part was seen; all is told as a correction of it
  StereoRig base;   // what the parts below add to
  std::vector<RigWithoutPart> earlier;  // whose folders are not given, and which base contains
  std::vector<GivenPart> parts;
};

const StereoRig& StartOf(const PooledRig& given) {
  return given.pool ? given.pool->start : given.rig;
}

// Rotations are written to rounding.
constexpr double kRounding = 1e-9;

// In what no correction changes.
bool IsSameKind(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.k3 == b.k3 &&
         std::abs(a.fy / a.fx - b.fy / b.fx) < kRounding;
}

bool DoStateTheSame(const RigSigmas& a, const RigSigmas& b) {
  const auto all = [](const RigSigmas& s) {
    return std::tie(s.rotation_deg, s.focal_pct, s.principal_point_px, s.distortion_px, s.board_px);
  };
  return all(a) == all(b);
}

bool IsSameRig(const StereoRig& a, const StereoRig& b) {
  const auto& known = a.calibration_covariance;
  return IsSameKind(a.left.camera, b.left.camera) && IsSameKind(a.right.camera, b.right.camera) &&
         CorrectionBetween(a, b).cwiseAbs().maxCoeff() < kRounding &&
         a.right_from_left.translation.isApprox(b.right_from_left.translation, kRounding) &&
         DoStateTheSame(a.stated_sigmas, b.stated_sigmas) &&
         known.has_value() == b.calibration_covariance.has_value() &&
         (!known || known->isApprox(*b.calibration_covariance, kRounding));
}

std::vector<GivenPart> ReadParts(const std::vector<std::filesystem::path>& outs) {
  std::vector<GivenPart> parts;
  for (const std::filesystem::path& out : outs) {
    auto part = ReadCalibration(out);
    if (!part) {
      spdlog::warn("{}: tells nothing of its rig: too short a way, or too few frames",
                   out.string());
      continue;
    }
    parts.push_back({out.string(), std::move(*part)});
  }
  if (parts.empty()) throw DataError("expected a part that tells something of its rig, found none");
  return parts;
}

// One rig at the root of all, and no image twice.
void RequireCommensurable(const std::vector<GivenPart>& parts) {
  for (const GivenPart& part : parts) {
    const GivenPart& first = parts.front();
    if (!IsSameRig(StartOf(part.calibration.given), StartOf(first.calibration.given))) {
      throw DataError(
          fmt::format("{}: expected a part made with the rig file of {} or one pooled "
                      "from it, found another",
                      part.name, first.name));
    }
    for (const GivenPart* other = &first; other != &part; ++other) {
      const int shared = SharedFrames(other->calibration.frames, part.calibration.frames);
      if (shared == 0) continue;
      throw DataError(
          fmt::format("{}: expected frames that no other part holds, found {} of {}: "
                      "they would count twice",
                      part.name, shared, other->name));
    }
  }
}

// Whether all parts began with the whole of one pool, which contains none of them.
bool AddToOnePool(const std::vector<GivenPart>& parts) {
  const PooledRig& first = parts.front().calibration.given;
  return first.pool && std::ranges::all_of(parts, [&](const GivenPart& part) {
           const PooledRig& given = part.calibration.given;
           return given.pool && IsSameRig(given.rig, first.rig) &&
                  given.pool->parts.size() == first.pool->parts.size() &&
                  !WithoutPart(given, part.calibration.frames);
         });
}

// What parts of earlier pools told is lost where not all that is given adds to one of them.
void SayWhatIsLost(const std::vector<GivenPart>& parts) {
  std::set<std::vector<std::string>> lost;
  for (const GivenPart& part : parts) {
    if (!part.calibration.given.pool) continue;
    for (const RigWithoutPart& earlier : part.calibration.given.pool->parts) {
      if (std::ranges::none_of(parts, [&](const GivenPart& given) {
            return SharedFrames(earlier.frames, given.calibration.frames) > 0;
          })) {
        lost.insert(earlier.frames);
      }
    }
  }
  if (lost.empty()) return;
  spdlog::warn(
      "the pool begins anew from the first rig file: what {} earlier parts told is not in "
      "it; name their folders as well",
      lost.size());
}

Pool ReadPool(const std::vector<std::filesystem::path>& outs) {
  Pool pool;
  pool.parts = ReadParts(outs);
  RequireCommensurable(pool.parts);
  const PooledRig& first = pool.parts.front().calibration.given;
  pool.start = StartOf(first);
  pool.base = RigBeforePool(first);  // with the masks, antenna and the like of the file itself
  if (AddToOnePool(pool.parts)) {
    pool.base = first.rig;
    pool.earlier = first.pool->parts;
  } else {
    SayWhatIsLost(pool.parts);
  }
  if (pool.parts.size() + pool.earlier.size() == 1) {
    spdlog::warn(
        "{} alone tells of the rig: its file is for other parts, and helps this one nothing",
        pool.parts.front().name);
  }
  return pool;
}

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
RigPool Contributions(const Pool& pool, const PooledCalibration& calibration,
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

std::string Table(const Pool& pool, const PooledCalibration& calibration,
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
void WarnOfContradictions(const Pool& pool, const PooledCalibration& calibration) {
  for (std::size_t i = 0; i < pool.parts.size(); ++i) {
    const double square = calibration.parts[i].square_per_parameter;
    if (pool.parts.size() == 1 || square <= kSameRigSquare) continue;
    spdlog::warn(
        "{} contradicts the others: it differs by {:.1f} squares per parameter (the same rig: at "
        "most {}); look whether all parts are of one rig, and calibrate without it",
        pool.parts[i].name, square, kSameRigSquare);
  }
}

// Only a rig file may be replaced.
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
  try {
    ReadRigFile(path);
  } catch (const DataError&) {
    throw DataError(fmt::format("{}: expected a rig file to replace or none, found something else",
                                path.string()));
  }
}

std::string TextOf(const AdjustmentOptions& options) {
  PartOptions text;
  text.adjustment = options;
  return WritePartOptions(text);
}

// That the parts were made with: how far rig files are taken to be off and noise to be shared.
AdjustmentOptions OptionsOf(const std::vector<std::filesystem::path>& outs) {
  std::optional<AdjustmentOptions> options;
  for (const std::filesystem::path& out : outs) {
    const auto config = out / "config.yaml";
    if (!std::filesystem::exists(config)) continue;  // a run is at work there, or was killed
    const AdjustmentOptions found = LoadPartOptions(config, {}).adjustment;
    if (!options) options = found;
    if (TextOf(found) == TextOf(*options)) continue;
    throw DataError(
        fmt::format("{}: expected the options of adjustment that {} was made with, found others",
                    config.string(), outs.front().string()));
  }
  return options.value_or(AdjustmentOptions{});
}

std::string CalibrateNow(const CalibrateRequest& request) {
  RequireRigOut(request.rig_out);
  const Pool pool = ReadPool(request.outs);
  const AdjustmentOptions options = OptionsOf(request.outs);
  const auto calibration =
      PoolCalibrations(WitnessesOf(pool.base, pool.parts), PriorOf(pool.base, options), options);
  if (!calibration) ThrowSingular();
  PooledRig pooled{Corrected(pool.base, calibration->pooled.correction),
                   Contributions(pool, *calibration, options)};
  pooled.rig.calibration_covariance = calibration->pooled.covariance;
  WriteFileAtomically(request.rig_out, [&](std::ostream& stream) {
    stream << fmt::format("# A rig as {} parts tell it together.\n", pooled.pool->parts.size())
           << WritePooledRigFile(pooled);
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
