#include "workflows/stages/sensor_gates.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dead_reckoning/contradictions.h"
#include "gates/gates.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/gates_report.h"

namespace rigmap {
namespace {

// Half of each such step at least is wrong on one side: a path that is good to a per cent cannot
// have more.
constexpr double kMostFlat = 0.02;

Report JudgeSensors(const Dataset& dataset, const AdjustedPart& part,
                    const DeadReckoningOptions& options, const FilterOptions& filter) {
  const auto found = FlatContradictions(dataset, part.odometry, options, filter);
  Gate gate{.name = "sensors_contradict", .limit = kMostFlat};
  if (!found) {
    gate.why = "the rover has no wheels or gyro that could tell";
    return ReportGates({gate});
  }
  gate.value = static_cast<double>(found->frames.size()) / found->steps;
  gate.passed = *gate.value <= kMostFlat;
  gate.why = "share of the images' steps that wheels and gyro flatly contradict";
  if (!found->frames.empty()) {
    gate.why += fmt::format(", those to the frames {}", fmt::join(found->frames, ", "));
  }
  return ReportGates({gate});
}

}  // namespace

SensorGatesCheck SensorGates() {
  return {.name = "sensor_gates",
          .code = CodeHere(),
          .make = JudgeSensors,
          .about = "whether wheels and gyro, if there are any, tell of the images' motion"};
}

}  // namespace rigmap
