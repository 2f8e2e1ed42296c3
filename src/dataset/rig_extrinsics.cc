// How the right camera and what else is on the vehicle lie to the left camera.
#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>

#include "core/error.h"
#include "dataset/internal/rig_nodes.h"

namespace rigmap {
namespace {

// No vehicle carries two cameras that far apart.
constexpr double kMaxBaseline_m = 10.0;
// Nor an antenna that far from them.
constexpr double kMaxLever_m = 30.0;
// Lenses that see metres are not so small.
constexpr double kMinBaseline_m = 0.002;
// Numbers in such files are rounded to six decimals or better.
constexpr double kMaxBaselineErrorM = 1e-6;
// Largest entry of R^T R - 1: three decimals are enough to tell a rotation from a typing error.
constexpr double kMaxRotationDefect = 1e-3;
// About one pixel over the width of an image.
constexpr double kMaxRectifiedErrorRad = 1e-3;

Eigen::Quaterniond ReadRotation(const YamlNode& node) {
  const auto numbers = node.AsDoubles(9);
  const Eigen::Matrix3d matrix =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  const double defect =
      (matrix.transpose() * matrix - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(defect <= kMaxRotationDefect)) {
    throw RigComplaint(node,
                       fmt::format("expected a rotation, R^T R = 1 to {}, found it off by {:.3g}",
                                   kMaxRotationDefect, defect));
  }
  if (matrix.determinant() < 0.0) {
    throw RigComplaint(node, "expected a rotation, determinant +1, found a reflection, -1");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  return Eigen::Quaterniond(nearest).normalized();
}

Eigen::Vector3d ReadVector(const YamlNode& node) {
  return Eigen::Vector3d(node.AsDoubles(3).data());
}

}  // namespace

Eigen::Vector3d ReadLever(const YamlNode& node) {
  const Eigen::Vector3d lever_m = ReadVector(node);
  if (lever_m.norm() <= kMaxLever_m) return lever_m;
  throw RigComplaint(node,
                     fmt::format("expected metres, at most {:g} m from the left camera, found "
                                 "{:.4g} m: are they millimetres?",
                                 kMaxLever_m, lever_m.norm()));
}

Rigid3 ReadRigid(const YamlNode& node) {
  node.RequireKeys({"R", "t"});
  return {ReadRotation(node.At("R")), ReadVector(node.At("t"))};
}

void CheckBaseline(const YamlNode& root, const StereoRig& rig) {
  const YamlNode& motion = root.At("right_from_left").At("t");
  if (!(rig.Baseline() > 0.0)) {
    throw RigComplaint(motion, "expected a baseline above 0 m, found 0 m");
  }
  if (rig.Baseline() < kMinBaseline_m) {
    throw RigComplaint(motion,
                       fmt::format("expected a baseline in metres, found {:.4g} m: is it in "
                                   "another unit?",
                                   rig.Baseline()));
  }
  if (rig.Baseline() > kMaxBaseline_m) {
    throw RigComplaint(motion,
                       fmt::format("expected a baseline in metres, found {:.4g} m: is it in "
                                   "millimetres, or the focal length times the baseline, as a "
                                   "projection matrix has it?",
                                   rig.Baseline()));
  }
  const double right_x_in_left = rig.right_from_left.Inverse().translation.x();
  if (!(right_x_in_left > 0.0)) {
    throw RigComplaint(motion,
                       fmt::format("expected the right camera to the right of the left one, "
                                   "found it {} m to the left: are the eyes or the direction "
                                   "swapped?",
                                   -right_x_in_left));
  }
  const YamlNode* baseline = root.Find("baseline_m");
  if (baseline && !(std::abs(baseline->AsDouble() - rig.Baseline()) <= kMaxBaselineErrorM)) {
    throw RigComplaint(*baseline,
                       fmt::format("expected baseline_m to equal the length of t, {:.7f} m "
                                   "(to {} m), found {}",
                                   rig.Baseline(), kMaxBaselineErrorM, baseline->scalar));
  }
}

void CheckRectified(const YamlNode& root, const Rigid3& right_from_left) {
  const YamlNode* rectified = root.Find("rectified");
  if (!rectified || !rectified->AsBool()) return;
  const double turn_rad = AngleOf(right_from_left.rotation);
  const Eigen::Vector3d& t = right_from_left.translation;
  const double slant_rad = std::atan2(t.tail<2>().norm(), -t.x());
  if (turn_rad > kMaxRectifiedErrorRad || slant_rad > kMaxRectifiedErrorRad) {
    throw RigComplaint(*rectified,
                       fmt::format("expected R = 1 and t along -x (to {} rad) where rectified is "
                                   "true, found R turned by {:.4g} rad, t by {:.4g} rad",
                                   kMaxRectifiedErrorRad, turn_rad, slant_rad));
  }
}

}  // namespace rigmap
