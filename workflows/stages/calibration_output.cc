#include "workflows/stages/calibration_output.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "adjustment/calibration.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/json_text.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

template <class Matrix>
Json Numbers(const Matrix& matrix) {
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

// Matrices are symmetric, so that the order of rows and columns does not matter. Throws
// std::invalid_argument.
template <class Matrix>
Matrix Read(const Json& numbers) {
  const auto values = numbers.get<std::vector<double>>();
  if (values.size() != static_cast<std::size_t>(Matrix::SizeAtCompileTime)) {
    throw std::invalid_argument(fmt::format("expected {} numbers, found {}",
                                            int{Matrix::SizeAtCompileTime}, values.size()));
  }
  const Matrix matrix = Eigen::Map<const Matrix>(values.data());
  if (!matrix.allFinite()) throw std::invalid_argument("expected numbers, found an infinite one");
  return matrix;
}

// Throws std::invalid_argument where a block's information is none: rounding is small beside what
// the whole part tells.
void RequireInformation(const CalibrationEquations& equations) {
  constexpr double kRounding = 1e-6, kLeast = 1e-150;
  const CalibrationVector scale =
      equations.information.diagonal().cwiseAbs().cwiseMax(kLeast).cwiseSqrt().cwiseInverse();
  const auto is_information = [&](const CalibrationBlock& block) {
    const CalibrationMatrix scaled = scale.asDiagonal() * block.information * scale.asDiagonal();
    if ((scaled - scaled.transpose()).cwiseAbs().maxCoeff() > kRounding) return false;
    const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> solver(scaled, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().minCoeff() > -kRounding;
  };
  const auto all_are = [&](const std::vector<CalibrationBlock>& blocks) {
    return std::ranges::all_of(blocks, is_information);
  };
  if (all_are(equations.stretches) && all_are(equations.regions)) return;
  throw std::invalid_argument(
      "expected information that is symmetric and nowhere negative, found other");
}

Json WriteBlock(const CalibrationBlock& block, double inflation) {
  return {{"score", Numbers((block.score / inflation).eval())},
          {"information", Numbers((block.information / inflation).eval())}};
}

Json WriteBlocks(const std::vector<CalibrationBlock>& blocks, double inflation) {
  Json written = Json::array();
  for (const CalibrationBlock& block : blocks) written.push_back(WriteBlock(block, inflation));
  return written;
}

CalibrationBlock ReadBlock(const Json& written) {
  return {Read<CalibrationVector>(written.at("score")),
          Read<CalibrationMatrix>(written.at("information"))};
}

std::vector<CalibrationBlock> ReadBlocks(const Json& written) {
  std::vector<CalibrationBlock> blocks;
  for (const Json& block : written) blocks.push_back(ReadBlock(block));
  return blocks;
}

PartCalibration ReadPart(const Json& part, const std::filesystem::path& path) {
  PartCalibration read{ParsePooledRigFile(part.at("rig"), path),
                       part.at("frames"),
                       Read<CalibrationVector>(part.at("correction")),
                       {}};
  read.equations.stretches = ReadBlocks(part.at("stretches"));
  read.equations.regions = ReadBlocks(part.at("regions"));
  if (part.contains("field")) read.equations.of_field = ReadBlock(part.at("field"));
  read.equations.AddUp();
  RequireInformation(read.equations);
  read.equations.score_covariance = read.equations.information;
  return read;
}

Report CameraReport(const Camera& camera) {
  return {{"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx},
          {"cy", camera.cy}, {"k1", camera.k1}, {"k2", camera.k2},
          {"p1", camera.p1}, {"p2", camera.p2}, {"k3", camera.k3}};
}

Report RigReport(const StereoRig& rig) {
  const auto rotation_deg =
      Eigen::Vector3d(180.0 / std::numbers::pi * LogRotation(rig.right_from_left.rotation));
  return {{"left", CameraReport(rig.left.camera)},
          {"right", CameraReport(rig.right.camera)},
          {"right_from_left_deg", {rotation_deg.x(), rotation_deg.y(), rotation_deg.z()}},
          {"baseline_m", rig.Baseline()}};
}

}  // namespace

void PublishCalibration(const Dataset& dataset, const DatasetContent& content,
                        const Adjustment& adjustment, Publication& publication) {
  std::vector<std::string> frames = content.images;
  std::erase(frames, "");
  Json part = {{"rig", WritePooledRigFile({dataset.rig, dataset.rig_pool})},
               {"frames", frames},
               {"correction", Numbers(adjustment.rig_correction)},
               {"stretches", Json::array()},
               {"regions", Json::array()}};
  if (adjustment.calibration) {
    const double inflation = adjustment.calibration_inflation;
    part["stretches"] = WriteBlocks(adjustment.calibration->stretches, inflation);
    part["regions"] = WriteBlocks(adjustment.calibration->regions, inflation);
    if (adjustment.calibration->HasField()) {
      part["field"] = WriteBlock(adjustment.calibration->of_field, inflation);
    }
  }
  publication.File("calibration.json",
                   [&](std::ostream& stream) { stream << JsonText(part) << "\n"; });
}

std::optional<PartCalibration> ReadCalibration(const std::filesystem::path& out) {
  const std::filesystem::path path = out / "calibration.json";
  if (!std::filesystem::exists(path)) {
    throw DataError(
        fmt::format("{}: expected calibration.json, which the technique rig writes "
                    "with its adjustment, found none",
                    out.string()));
  }
  const std::string text = ReadTextFile(path);
  try {
    return TakeFromJson(path, "what rigmap part writes there", [&] {
      PartCalibration part = ReadPart(Json::parse(text), path);
      return part.equations.stretches.empty() ? std::nullopt : std::optional(std::move(part));
    });
  } catch (const std::invalid_argument& error) {
    throw DataError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

Report DescribeRigChange(const StereoRig& calibrated, const Adjustment& adjustment) {
  const StereoRig& used = adjustment.rig;
  const Eigen::Vector3d turn_deg =
      180.0 / std::numbers::pi *
      LogRotation(used.right_from_left.rotation * calibrated.right_from_left.rotation.conjugate());
  const Camera &is = used.left.camera, &was = calibrated.left.camera;
  const double focal_pct = 100.0 * (is.fx / was.fx - 1.0),
               aspect_pct = 100.0 * (is.fy / is.fx / (was.fy / was.fx) - 1.0);
  return {{"refined", adjustment.IsRigCorrected()},
          {"parameters", NameOf(adjustment.refined)},
          {"right_eye_turned_deg", {turn_deg.x(), turn_deg.y(), turn_deg.z()}},
          {"focal_changed_pct", focal_pct},
          {"aspect_changed_pct", aspect_pct},
          {"largest_shift_px", adjustment.correction_px},
          {"infinity_offset_px", adjustment.infinity_offset_px},
          {"infinity_offset_sigma_px", adjustment.infinity_offset_sigma_px},
          {"prior_factor", adjustment.prior_factor},
          {"lens_field_rms_px", adjustment.lens_field_rms_px},
          {"flexure_px", Numbers(FlexurePx(used.right.camera, adjustment.right_turns))},
          {"given", RigReport(calibrated)},
          {"used", RigReport(used)}};
}

}  // namespace rigmap
