// What a motion of the rig says of where points are seen again, and how it is refined. Of this room
// only.
#pragma once

#include <optional>
#include <span>

#include "correspondence/stereo_pose.h"

namespace rigmap {

// Within three sigmas of no disparity a point may be anywhere; those found by chance to have one
// lie nearer than they are, and all of them together would hold the rig where it was.
inline constexpr double kKnownShare = 1.0 / 3.0;

// What the disparity leaves unknown of a point's depth, as a share of it.
double DepthShare(const PointSighting& sighting);

// All must outlive it.
class PoseProblem {
 public:
  PoseProblem(std::span<const PointSighting> sightings, const StereoRig& rig,
              const StereoPoseOptions& options);

  double MaxSquared() const { return options_.max_sigmas * options_.max_sigmas; }

  // Sum of truncated squares: less is better (MSAC, Torr and Zisserman 2000). Not summed further
  // than `enough`.
  double Cost(const Rigid3& motion, double enough) const;

  // Iteratively reweighted Gauss-Newton steps over sightings within a gate that starts wide, since
  // a three-point pose is rough, and closes. The normal matrix of the last, or nothing if one is
  // singular.
  std::optional<Matrix6d> Refine(Rigid3& motion) const;

  // Of a refined motion with its normal matrix; without metres_sigma.
  StereoPose Judge(const Rigid3& motion, const Matrix6d& normal) const;

 private:
  using Vector4 = Eigen::Vector4d;

  // Residual (normalised coordinates, left then right; right rows zero where unseen), its Jacobian
  // for a left perturbation, and how it answers to the point's depth and to the reference's
  // keypoint.
  struct Linearised {
    Vector4 residual = Vector4::Zero();
    Eigen::Matrix<double, 4, 6> jacobian = Eigen::Matrix<double, 4, 6>::Zero();
    Vector4 depth_response = Vector4::Zero();  // for one sigma of depth
    Eigen::Matrix<double, 4, 2> keypoint_response = Eigen::Matrix<double, 4, 2>::Zero();
  };

  // Nothing for a point that falls behind a camera.
  std::optional<Linearised> Linearise(const PointSighting& sighting, const Rigid3& motion) const;
  Eigen::Matrix4d Information(const Linearised& at) const;
  // Squared distance in sigmas per seen eye; infinite behind a camera.
  double SquaredSigmas(const PointSighting& sighting, const Rigid3& motion) const;
  double SquaredSigmas(const PointSighting& sighting, const Rigid3& motion,
                       const Eigen::Matrix3d& turn) const;
  OffsetEffect OffsetOf(const Rigid3& motion) const;
  std::optional<Matrix6d> Step(double gate_squared, Rigid3& motion) const;
  template <class Use>
  void ForEachWithin(double gate_squared, const Rigid3& motion, const Use& use) const;
  Vector4 OffsetResponse(const PointSighting& sighting, const Rigid3& motion) const;

  std::span<const PointSighting> sightings_;
  const StereoRig& rig_;
  Eigen::Matrix3d right_turn_;
  const StereoPoseOptions& options_;
  double noise_, reference_noise_;
};

}  // namespace rigmap
