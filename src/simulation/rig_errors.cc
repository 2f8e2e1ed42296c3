#include "simulation/rig_errors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"
#include "core/error.h"
#include "simulation/internal/seeded_noise.h"

namespace rigmap {
namespace {

// Of the right eye about an axis of its own; its place stays, and so does the baseline.
template <int kAxis>
void TurnRightEye(StereoRig& rig, double degrees) {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  turn[kAxis] = degrees * std::numbers::pi / 180.0;
  rig.right_from_left = Rigid3{ExpRotation(turn), Eigen::Vector3d::Zero()} * rig.right_from_left;
}

void ScaleFocals(StereoRig& rig, double per_cent) {
  const double factor = 1.0 + per_cent / 100.0;
  for (Camera* camera : {&rig.left.camera, &rig.right.camera}) {
    camera->fx *= factor;
    camera->fy *= factor;
  }
}

void SquashPixels(StereoRig& rig, double per_cent) {
  rig.left.camera.fx /= 1.0 + per_cent / 100.0;
  rig.right.camera.fx /= 1.0 + per_cent / 100.0;
}

void ScaleBaseline(StereoRig& rig, double per_cent) {
  rig.right_from_left.translation *= 1.0 + per_cent / 100.0;
}

// What a rig file may be off by as the adjustment takes it to be, in all parameters at once.
CalibrationVector DrawnError(const StereoRig& rig, std::uint64_t seed) {
  const CalibrationMatrix covariance = PriorOf(rig, AdjustmentOptions()).information.inverse();
  SeededNoise noise(seed, "rig file");
  const auto normal = [&] { return noise.Normal(1.0); };
  return covariance.llt().matrixL() * CalibrationVector::NullaryExpr(normal);
}

template <int kTimes>
void AddDrawnError(StereoRig& rig, double seed) {
  rig = Corrected(rig, kTimes * DrawnError(rig, static_cast<std::uint64_t>(seed)));
}

struct RigError {
  std::string_view name, meaning;
  void (*apply)(StereoRig& rig, double value);
  double least, most;
  bool is_whole = false;
};

constexpr double kMostDegrees = 45.0, kMostPx = 10'000.0, kMostSeed = 1e15;

constexpr std::array<RigError, 13> kRigErrors{{
    {"turn-x", "degrees that the right eye is turned about its x axis (pitch)", &TurnRightEye<0>,
     -kMostDegrees, kMostDegrees},
    {"turn-y", "about its y axis (yaw)", &TurnRightEye<1>, -kMostDegrees, kMostDegrees},
    {"turn-z", "about its z axis (roll)", &TurnRightEye<2>, -kMostDegrees, kMostDegrees},
    {"left-cx", "px, principal point of the left eye",
     [](StereoRig& rig, double px) { rig.left.camera.cx += px; }, -kMostPx, kMostPx},
    {"left-cy", "", [](StereoRig& rig, double px) { rig.left.camera.cy += px; }, -kMostPx, kMostPx},
    {"right-cx", "px, of the right eye",
     [](StereoRig& rig, double px) { rig.right.camera.cx += px; }, -kMostPx, kMostPx},
    {"right-cy", "", [](StereoRig& rig, double px) { rig.right.camera.cy += px; }, -kMostPx,
     kMostPx},
    {"focal", "per cent, focal lengths of both eyes", &ScaleFocals, -90.0, 900.0},
    {"aspect", "per cent, fy / fx of both eyes, fx alone being wrong", &SquashPixels, -90.0, 900.0},
    {"k1", "first coefficient of radial distortion, both eyes",
     [](StereoRig& rig, double k1) {
       rig.left.camera.k1 += k1;
       rig.right.camera.k1 += k1;
     },
     -1.0, 1.0},
    {"drawn", "all but the baseline, as rigmap expects them of a rig file; the value is a seed",
     &AddDrawnError<1>, 0.0, kMostSeed, true},
    {"drawn-double", "the same, twice as large", &AddDrawnError<2>, 0.0, kMostSeed, true},
    {"baseline", "per cent, length of the baseline: no gate can see it", &ScaleBaseline, -90.0,
     900.0},
}};

double ParseValue(const RigError& error, const std::string& spec, std::string_view text) {
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = result.ec == std::errc() && result.ptr == text.data() + text.size();
  if (!is_number || !(value >= error.least && value <= error.most) ||
      (error.is_whole && value != std::floor(value))) {
    throw UsageError(fmt::format("--rig-error {}: expected a {}number from {} to {}, found '{}'",
                                 spec, error.is_whole ? "whole " : "", error.least, error.most,
                                 text));
  }
  return value;
}

const RigError& Named(const std::string& spec, std::string_view name) {
  std::string names;
  for (const RigError& error : kRigErrors) {
    if (error.name == name) return error;
    names += names.empty() ? "" : ", ";
    names += error.name;
  }
  throw UsageError(fmt::format("--rig-error {}: expected one of {}", spec, names));
}

}  // namespace

StereoRig WithRigErrors(const StereoRig& rig, std::span<const std::string> specs) {
  StereoRig told = rig;
  for (const std::string& spec : specs) {
    const auto equals = spec.find('=');
    if (equals == std::string::npos) {
      throw UsageError(fmt::format("--rig-error {}: expected NAME=VALUE", spec));
    }
    const std::string_view all = spec;
    const RigError& error = Named(spec, all.substr(0, equals));
    error.apply(told, ParseValue(error, spec, all.substr(equals + 1)));
  }
  return told;
}

std::string DescribeRigErrorNames() {
  std::string text;
  for (const RigError& error : kRigErrors) {
    text += fmt::format("  {:12} {}\n", error.name, error.meaning);
  }
  return text;
}

}  // namespace rigmap
