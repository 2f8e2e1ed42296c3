#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <vector>

#include "core/yaml.h"
#include "dataset/internal/rig_nodes.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

std::vector<double> UpperTriangle(const CalibrationMatrix& matrix) {
  std::vector<double> numbers;
  for (int row = 0; row < kCalibrationSize; ++row) {
    for (int column = row; column < kCalibrationSize; ++column) {
      numbers.push_back(matrix(row, column));
    }
  }
  return numbers;
}

std::string FormatEye(const RigEye& eye) {
  const Camera& camera = eye.camera;
  std::string text = fmt::format(
      "  model: {}\n  width: {}\n  height: {}\n  fx: {}\n  fy: {}\n  cx: {}\n  cy: {}\n"
      "  distortion: [{}, {}, {}, {}{}]\n",
      camera.IsPinhole() ? "PINHOLE"
      : camera.k3 == 0.0 ? "OPENCV"
                         : "FULL_OPENCV",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.k1, camera.k2,
      camera.p1, camera.p2, camera.k3 == 0.0 ? "" : fmt::format(", {}, 0, 0, 0", camera.k3));
  if (const auto& region = eye.calibrated_region) {
    text += fmt::format("  calibrated_region: [{}, {}, {}, {}]\n", region->x0, region->y0,
                        region->x1, region->y1);
  }
  if (!eye.mask_path.empty()) text += fmt::format("  mask: {}\n", QuoteYaml(eye.mask_path));
  return text;
}

std::string FormatVector(const Eigen::Vector3d& vector) {
  return fmt::format("[{}, {}, {}]", vector.x(), vector.y(), vector.z());
}

std::string FormatRigid(const Rigid3& motion) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> matrix = motion.rotation.toRotationMatrix();
  return fmt::format("  R: [{}]\n  t: {}\n",
                     fmt::join(matrix.data(), matrix.data() + matrix.size(), ", "),
                     FormatVector(motion.translation));
}

// A covariance takes the place of single sigmas.
std::string FormatSigmas(const StereoRig& rig) {
  std::string text;
  const auto add = [&](const char* key, const std::optional<double>& sigma) {
    if (sigma) text += fmt::format("  {}: {}\n", key, *sigma);
  };
  add("baseline_m", rig.baseline_sigma_m);
  if (rig.calibration_covariance) {
    return text + fmt::format("  covariance: {}\n", FormatCovariance(*rig.calibration_covariance));
  }
  const RigSigmas& stated = rig.stated_sigmas;
  add("rotation_deg", stated.rotation_deg);
  add("focal_pct", stated.focal_pct);
  add("aspect_pct", stated.aspect_pct);
  add("principal_point_px", stated.principal_point_px);
  add("distortion_px", stated.distortion_px);
  add("board_px", stated.board_px);
  return text;
}

}  // namespace

std::string FormatCovariance(const CalibrationMatrix& covariance) {
  return fmt::format("[{}]", fmt::join(UpperTriangle(covariance), ", "));
}

std::string WriteRigFile(const StereoRig& rig) {
  std::string text = fmt::format("left:\n{}right:\n{}right_from_left:\n{}", FormatEye(rig.left),
                                 FormatEye(rig.right), FormatRigid(rig.right_from_left));
  if (rig.antenna_in_left) {
    text += fmt::format("antenna_in_left: {}\n", FormatVector(*rig.antenna_in_left));
  }
  if (rig.imu_from_left) text += fmt::format("imu_from_left:\n{}", FormatRigid(*rig.imu_from_left));
  if (rig.wheels) text += FormatWheels(*rig.wheels);
  const std::string sigmas = FormatSigmas(rig);
  return sigmas.empty() ? text : text + "sigmas:\n" + sigmas;
}

}  // namespace rigmap
