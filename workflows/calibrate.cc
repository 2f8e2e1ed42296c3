#include "workflows/calibrate.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "adjustment/pool_calibrations.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "dataset/rig_file.h"
#include "workflows/stages/calibration_output.h"

namespace rigmap {
namespace {

struct Pool {
  StereoRig rig;  // as the file of all of them gave it
  std::vector<std::string> names;
  std::vector<CalibrationWitness> witnesses;
};

Pool ReadPool(const std::vector<std::filesystem::path>& outs) {
  Pool pool;
  std::string first;
  for (const std::filesystem::path& out : outs) {
    const auto part = ReadCalibration(out);
    if (!part) {
      spdlog::warn("{}: tells nothing of its rig: too short a way, or too few frames",
                   out.string());
      continue;
    }
    const std::string text = WriteRigFile(part->rig);
    if (first.empty()) first = text;
    if (text != first) {
      throw DataError(fmt::format("{}: expected a part made with the rig file of {}, found another",
                                  out.string(), pool.names.front()));
    }
    pool.rig = part->rig;
    pool.names.push_back(out.string());
    pool.witnesses.push_back({part->correction, part->equations});
  }
  if (pool.names.empty()) {
    throw DataError("expected a part that tells something of its rig, found none");
  }
  if (pool.names.size() == 1) {
    spdlog::warn(
        "{} alone tells of the rig: its file is for other parts, and helps this one nothing",
        pool.names.front());
  }
  return pool;
}

std::string Table(const Pool& pool, const PooledCalibration& calibration) {
  const StereoRig pooled = Corrected(pool.rig, calibration.pooled.correction);
  std::string table = fmt::format(
      "corrected: {}; largest shift in the right image {:.2f} px, disparity at infinity {:+.3f} "
      "px\n"
      "{:32} {:>12} {:>12} {:>12}\n",
      NameOf(calibration.refined), LargestShiftPx(pool.rig, pooled),
      DisparityAtInfinity(pooled) - DisparityAtInfinity(pool.rig), "part", "infinity px",
      "others px", "difference");
  for (std::size_t i = 0; i < pool.names.size(); ++i) {
    const WitnessComparison& part = calibration.parts[i];
    const auto infinity_px = [&](const ProbableCorrection& correction) {
      return DisparityAtInfinity(Corrected(pool.rig, correction.correction)) -
             DisparityAtInfinity(pool.rig);
    };
    table +=
        fmt::format("{:32} {:>+12.3f} {:>+12.3f} {:>12.2f}\n", pool.names[i],
                    infinity_px(part.alone), infinity_px(part.others), part.square_per_parameter);
  }
  return table +
         "difference: square per parameter between the part and all others, in units of what both "
         "leave unknown; the same rig has about 1\n";
}

std::string CalibrateNow(const CalibrateRequest& request) {
  const Pool pool = ReadPool(request.outs);
  const AdjustmentOptions options;
  const auto calibration = PoolCalibrations(pool.witnesses, PriorOf(pool.rig, options), options);
  if (!calibration) throw DataError("expected parts that tell a calibration, found them singular");
  StereoRig rig = Corrected(pool.rig, calibration->pooled.correction);
  rig.calibration_covariance = calibration->pooled.covariance;
  WriteFileAtomically(request.rig_out, [&](std::ostream& stream) {
    stream << fmt::format(
                  "# A rig as {} parts tell it together. For other parts of the same rig.\n",
                  pool.names.size())
           << WriteRigFile(rig);
  });
  return Table(pool, *calibration);
}

}  // namespace

std::string Calibrate(const CalibrateRequest& request) {
  Job job(1, false);  // messages go to standard error
  return job.Run([&] { return CalibrateNow(request); });
}

}  // namespace rigmap
