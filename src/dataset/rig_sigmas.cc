// What a rig file states of how well it is known.
#include <fmt/format.h>

#include <Eigen/Cholesky>

#include "core/error.h"
#include "dataset/internal/rig_nodes.h"

namespace rigmap {
namespace {

RigSigmas ReadSingleSigmas(const YamlNode& node) {
  RigSigmas stated;
  for (const auto& [key, sigma] : {std::pair{"rotation_deg", &stated.rotation_deg},
                                   {"focal_pct", &stated.focal_pct},
                                   {"aspect_pct", &stated.aspect_pct},
                                   {"principal_point_px", &stated.principal_point_px},
                                   {"distortion_px", &stated.distortion_px},
                                   {"board_px", &stated.board_px}}) {
    const YamlNode* found = node.Find(key);
    if (!found) continue;
    *sigma = found->AsDouble();
    if (!(**sigma > 0.0)) {
      throw RigComplaint(*found, fmt::format("expected a sigma above 0, found {}", found->scalar));
    }
    if (node.Find("covariance")) {
      throw RigComplaint(*found, fmt::format("expected a covariance or single sigmas, found {} "
                                             "beside a covariance",
                                             key));
    }
  }
  return stated;
}

}  // namespace

void ReadSigmasNode(const YamlNode& node, StereoRig& rig) {
  node.RequireKeys({"baseline_m", "covariance", "rotation_deg", "focal_pct", "aspect_pct",
                    "principal_point_px", "distortion_px", "board_px"});
  if (const YamlNode* baseline = node.Find("baseline_m")) {
    const double sigma_m = baseline->AsDouble();
    if (!(sigma_m >= 0.0)) {
      throw RigComplaint(*baseline, fmt::format("expected a sigma, found {}", sigma_m));
    }
    rig.baseline_sigma_m = sigma_m;
  }
  rig.stated_sigmas = ReadSingleSigmas(node);
  if (const YamlNode* covariance = node.Find("covariance")) {
    rig.calibration_covariance = ReadCovariance(*covariance);
  }
}

CalibrationMatrix ReadCovariance(const YamlNode& node) {
  constexpr int kNumbers = kCalibrationSize * (kCalibrationSize + 1) / 2;
  const auto numbers = node.AsDoubles(kNumbers);
  CalibrationMatrix covariance;
  auto next = numbers.begin();
  for (int row = 0; row < kCalibrationSize; ++row) {
    for (int column = row; column < kCalibrationSize; ++column) {
      covariance(row, column) = covariance(column, row) = *next++;
    }
  }
  // Scaled, since its parameters are of very different size.
  const CalibrationVector scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const CalibrationMatrix correlations = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (!correlations.allFinite() || correlations.llt().info() != Eigen::Success) {
    throw RigComplaint(node, "expected a covariance, found a matrix that is not positive definite");
  }
  return covariance;
}

}  // namespace rigmap
