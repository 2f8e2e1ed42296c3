#include "simulation/internal/rtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "simulation/internal/seeded_noise.h"

namespace rigmap {
namespace {

constexpr double kInterval_s = 3.0;
const Eigen::Vector3d kFixedSigma_m{0.004, 0.005, 0.009};
const Eigen::Vector3d kFloatSigma_m{0.18, 0.22, 0.40};
constexpr double kFloatShare = 0.4;  // of an outage

enum class Reception { kFixed, kFloat, kNone };

Reception ReceptionAt(const std::vector<TimeSpan>& outages, double time_s) {
  Reception worst = Reception::kFixed;
  for (const TimeSpan& outage : outages) {
    if (!outage.Contains(time_s)) continue;
    const double share = (time_s - outage.begin_s) / (outage.end_s - outage.begin_s);
    worst = std::max(worst, share < kFloatShare ? Reception::kFloat : Reception::kNone);
  }
  return worst;
}

// The receiver states its height a little less sure at times. Draws the same number of random
// numbers whatever the reception, so that an outage changes nothing outside itself.
Eigen::Vector3d StatedSigmas(Reception reception, SeededNoise& noise) {
  const double unsure_m = noise.Between(0.0, 1.0) < 0.6 ? 0.001 : 0.0;
  if (reception == Reception::kFloat) return kFloatSigma_m;
  return kFixedSigma_m + Eigen::Vector3d(0.0, 0.0, unsure_m);
}

// Receivers speak in degrees and minutes with so many decimals of a minute.
double RoundedToMinutes(double degrees) { return std::round(degrees * 60.0 * 1e8) / (60.0 * 1e8); }

}  // namespace

std::vector<GnssFix> SimulateRtk(const RoverMotion& motion, const RoverMount& mount,
                                 const LocalFrame& local, const SensorClock& clock,
                                 const RtkFaults& faults) {
  SeededNoise noise(clock.seed, "rtk");
  const double end_s = motion.path().duration_s() + kSensorsAfter_s;
  const double first_s = -kSensorsBefore_s + noise.Between(0.0, kInterval_s);
  std::vector<GnssFix> fixes;
  for (int i = 0; first_s + i * kInterval_s < end_s; ++i) {
    const double jitter_s = noise.Normal(0.0008);
    const Eigen::Vector3d unit_error = noise.Normal(Eigen::Vector3d::Ones());
    GnssFix fix;
    fix.stamp_ns = clock.StampAt(first_s + i * kInterval_s + jitter_s + faults.clock_offset_s);
    const double time_s = clock.TimeAt(fix.stamp_ns) - faults.clock_offset_s;
    const Reception reception = ReceptionAt(faults.outages, time_s);
    fix.sigma_enu_m = StatedSigmas(reception, noise);
    if (reception == Reception::kNone) continue;
    fix.status = reception == Reception::kFixed ? std::string(kRtkFixed) : "RTK_FLOAT";
    const Eigen::Vector3d sigma_m = reception == Reception::kFixed ? kFixedSigma_m : kFloatSigma_m;
    const Eigen::Vector3d antenna = motion.WorldFromBody(time_s) * mount.AntennaInBody();
    const Geodetic measured = local.ToGeodetic(antenna + sigma_m.cwiseProduct(unit_error));
    fix.latitude_deg = measured.latitude_deg;
    fix.longitude_deg = measured.longitude_deg;
    fix.altitude_m = measured.altitude_m;
    fixes.push_back(fix);
  }
  return fixes;
}

void WriteRtkRows(std::ostream& stream, std::span<const GnssFix> fixes) {
  for (const GnssFix& fix : fixes) {
    stream << fmt::format("{} {} {:.15g} {:.15g} {:.9g} {:.3g} {:.3g} {:.3g}\n",
                          FormatKatwijkStampAsRecorded(fix.stamp_ns), fix.status,
                          RoundedToMinutes(fix.latitude_deg), RoundedToMinutes(fix.longitude_deg),
                          std::round(fix.altitude_m * 1000.0) / 1000.0, fix.sigma_enu_m.y(),
                          fix.sigma_enu_m.x(), fix.sigma_enu_m.z());
  }
}

}  // namespace rigmap
