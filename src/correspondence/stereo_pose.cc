#include "correspondence/stereo_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/statistics.h"
#include "correspondence/internal/three_point_poses.h"

namespace rigmap {
namespace {

using Vector4 = Eigen::Vector4d;

// Residual (normalised coordinates, left then right; right rows zero where unseen), its Jacobian
// for a left perturbation, and how it answers to the point's depth and to the reference's keypoint.
struct Linearised {
  Vector4 residual = Vector4::Zero();
  Eigen::Matrix<double, 4, 6> jacobian = Eigen::Matrix<double, 4, 6>::Zero();
  Vector4 depth_response = Vector4::Zero();  // for one sigma of depth
  Eigen::Matrix<double, 4, 2> keypoint_response = Eigen::Matrix<double, 4, 2>::Zero();  // likewise
};

Eigen::Matrix<double, 2, 3> ProjectionJacobian(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 2, 3> j;
  j << 1.0 / x.z(), 0.0, -x.x() / (x.z() * x.z()), 0.0, 1.0 / x.z(), -x.y() / (x.z() * x.z());
  return j;
}

// What the disparity leaves unknown of a point's depth, as a share of it.
double DepthShare(const PointSighting& sighting) {
  return sighting.depth_sigma_m / sighting.x_in_reference.norm();
}

// Within three sigmas of no disparity a point may be anywhere; those found by chance to have one
// lie nearer than they are, and all of them together would hold the rig where it was.
constexpr double kKnownShare = 1.0 / 3.0;

class PoseProblem {
 public:
  PoseProblem(std::span<const PointSighting> sightings, const StereoRig& rig,
              const StereoPoseOptions& options)
      : sightings_(sightings),
        rig_(rig),
        right_turn_(rig.right_from_left.rotation.toRotationMatrix()),
        options_(options),
        noise_(options.noise_px / rig.left.camera.MeanFocal()),
        reference_noise_(options.reference_noise_px / rig.left.camera.MeanFocal()) {}

  // Nothing for a point that falls behind a camera.
  std::optional<Linearised> Linearise(const PointSighting& sighting, const Rigid3& motion) const {
    const Eigen::Vector3d in_left = motion * sighting.x_in_reference;
    const Eigen::Vector3d in_right = rig_.right_from_left * in_left;
    if (!(in_left.z() > 0.0) || !(in_right.z() > 0.0)) return std::nullopt;
    const Eigen::Vector3d ray = sighting.x_in_reference.normalized() * sighting.depth_sigma_m;
    const Eigen::Vector3d depth_step = motion.rotation * ray;
    const Eigen::Matrix<double, 3, 2> keypoint_step =
        reference_noise_ * sighting.x_in_reference.z() *
        motion.rotation.toRotationMatrix().leftCols<2>();
    Eigen::Matrix<double, 3, 6> motion_jacobian;
    motion_jacobian << Eigen::Matrix3d::Identity(), -Skew(in_left);
    if (DepthShare(sighting) > kKnownShare) motion_jacobian.leftCols<3>().setZero();
    Linearised result;
    const Eigen::Matrix<double, 2, 3> left = ProjectionJacobian(in_left);
    result.residual.head<2>() = in_left.hnormalized() - sighting.left;
    result.jacobian.topRows<2>() = left * motion_jacobian;
    result.depth_response.head<2>() = left * depth_step;
    result.keypoint_response.topRows<2>() = left * keypoint_step;
    if (sighting.right) {
      const Eigen::Matrix<double, 2, 3> right =
          ProjectionJacobian(in_right) * rig_.right_from_left.rotation.toRotationMatrix();
      result.residual.tail<2>() = in_right.hnormalized() - *sighting.right;
      result.jacobian.bottomRows<2>() = right * motion_jacobian;
      result.depth_response.tail<2>() = right * depth_step;
      result.keypoint_response.bottomRows<2>() = right * keypoint_step;
    }
    return result;
  }

  // Inverse covariance of the residual, by Sherman and Morrison, which bears responses of any size:
  // points may come to lie beside a camera.
  Eigen::Matrix4d Information(const Linearised& at) const {
    Eigen::Matrix4d information = Eigen::Matrix4d::Identity() / (noise_ * noise_);
    const auto add = [&](const Vector4& response) {
      const Vector4 scaled = information * response;
      information -= scaled * scaled.transpose() / (1.0 + response.dot(scaled));
    };
    add(at.depth_response);
    if (reference_noise_ > 0.0) {
      for (const Vector4 response : at.keypoint_response.colwise()) add(response);
    }
    return information;
  }

  // Squared distance in sigmas per seen eye; infinite behind a camera.
  double SquaredSigmas(const PointSighting& sighting, const Rigid3& motion) const {
    return SquaredSigmas(sighting, motion, motion.rotation.toRotationMatrix());
  }

  double MaxSquared() const { return options_.max_sigmas * options_.max_sigmas; }

  // Sum of truncated squares: less is better (MSAC, Torr and Zisserman 2000). Not summed further
  // than `enough`.
  double Cost(const Rigid3& motion, double enough) const {
    const Eigen::Matrix3d turn = motion.rotation.toRotationMatrix();
    double cost = 0.0;
    for (const auto& sighting : sightings_) {
      cost += std::min(SquaredSigmas(sighting, motion, turn), MaxSquared());
      if (cost >= enough) break;
    }
    return cost;
  }

  // Depths of the reference's points and the right eye's sightings answer to an offset together.
  OffsetEffect OffsetOf(const Rigid3& motion) const {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d mixed = Vector6d::Zero(), gradient = Vector6d::Zero();
    double own = 0.0, along = 0.0;
    ForEachWithin(
        MaxSquared(), motion,
        [&](const PointSighting& sighting, const Linearised& at, const Eigen::Matrix4d& weight) {
          const Vector4 response = OffsetResponse(sighting, motion);
          normal += at.jacobian.transpose() * weight * at.jacobian;
          mixed += at.jacobian.transpose() * weight * response;
          gradient += at.jacobian.transpose() * weight * at.residual;
          own += response.dot(weight * response);
          along += response.dot(weight * at.residual);
        });
    const Eigen::LDLT<Matrix6d> solver(normal);
    const Vector6d following = -solver.solve(mixed);
    const double length_m = motion.translation.norm();
    if (!following.allFinite() || !(length_m > 0.0)) return {};
    return {.lengthening_m_per_px = motion.translation.dot(following.head<3>()) / length_m,
            .score = -(along + following.dot(gradient)),
            .information = own + following.dot(mixed)};
  }

  // One iteratively reweighted Gauss-Newton step over sightings within the gate, with Huber
  // weights; returns the normal matrix, or nothing if it is singular.
  std::optional<Matrix6d> Step(double gate_squared, Rigid3& motion) const {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    ForEachWithin(gate_squared, motion,
                  [&](const PointSighting&, const Linearised& at, const Eigen::Matrix4d& weight) {
                    normal += at.jacobian.transpose() * weight * at.jacobian;
                    gradient += at.jacobian.transpose() * weight * at.residual;
                  });
    const Eigen::LDLT<Matrix6d> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-14)) return std::nullopt;
    const Vector6d step = -solver.solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    motion = Rigid3{ExpRotation(step.tail<3>()), step.head<3>()} * motion;
    return normal;
  }

  std::optional<Matrix6d> Refine(Rigid3& motion) const {
    std::optional<Matrix6d> normal;
    // The gate starts wide, since a three-point pose is rough, and closes.
    for (const double widen : {9.0, 4.0, 1.0, 1.0, 1.0, 1.0}) {
      normal = Step(widen * MaxSquared(), motion);
      if (!normal) return std::nullopt;
    }
    return normal;
  }

  StereoPose Judge(const Rigid3& motion, const Matrix6d& normal) const {
    StereoPose result{.current_from_reference = motion,
                      .covariance = normal.inverse(),
                      .offset = OffsetOf(motion)};
    for (const auto& sighting : sightings_) {
      const bool inlier = SquaredSigmas(sighting, motion) <= MaxSquared();
      result.inliers.push_back(inlier);
      result.inlier_count += inlier ? 1 : 0;
    }
    return result;
  }

 private:
  // Calls `use` for each sighting within the gate, linearised, with its information times its
  // Huber weight.
  template <class Use>
  void ForEachWithin(double gate_squared, const Rigid3& motion, const Use& use) const {
    constexpr double kHuberSigmas = 1.5;
    for (const auto& sighting : sightings_) {
      const auto at = Linearise(sighting, motion);
      if (!at) continue;
      const Eigen::Matrix4d information = Information(*at);
      const double squared =
          at->residual.dot(information * at->residual) / (sighting.right ? 2.0 : 1.0);
      if (squared > gate_squared) continue;
      const double weight = std::min(1.0, kHuberSigmas / std::sqrt(std::max(squared, 1e-12)));
      use(sighting, *at, weight * information);
    }
  }

  // Of the residual, if a pixel of offset were taken from both frames' disparities.
  Vector4 OffsetResponse(const PointSighting& sighting, const Rigid3& motion) const {
    const double radians = 1.0 / rig_.left.camera.MeanFocal();
    const Eigen::Vector3d in_left = motion * sighting.x_in_reference;
    const Eigen::Vector3d farther = motion.rotation * sighting.x_in_reference *
                                    (sighting.x_in_reference.z() * radians / rig_.Baseline());
    Vector4 response = Vector4::Zero();
    response.head<2>() = ProjectionJacobian(in_left) * farther;
    if (sighting.right) {
      const Eigen::Vector3d in_right = rig_.right_from_left * in_left;
      response.tail<2>() = ProjectionJacobian(in_right) * (right_turn_ * farther) +
                           radians * rig_.right_from_left.translation.head<2>().normalized();
    }
    return response;
  }

  // `turn` is that of `motion`. Where only the depth is shared, without the matrices of Linearise
  // and Information: samples by the hundred ask for nothing else.
  double SquaredSigmas(const PointSighting& sighting, const Rigid3& motion,
                       const Eigen::Matrix3d& turn) const {
    if (reference_noise_ > 0.0) {
      const auto at = Linearise(sighting, motion);
      if (!at) return std::numeric_limits<double>::infinity();
      return at->residual.dot(Information(*at) * at->residual) / (sighting.right ? 2.0 : 1.0);
    }
    const Eigen::Vector3d turned = turn * sighting.x_in_reference;
    const Eigen::Vector3d in_left = turned + motion.translation;
    const Eigen::Vector3d in_right = right_turn_ * in_left + rig_.right_from_left.translation;
    if (!(in_left.z() > 0.0) || !(in_right.z() > 0.0)) {
      return std::numeric_limits<double>::infinity();
    }
    const Eigen::Vector3d depth_step =
        turned * (sighting.depth_sigma_m / sighting.x_in_reference.norm());
    double square = 0.0, along = 0.0, response = 0.0;
    const auto add = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& step,
                         const Eigen::Vector2d& seen) {
      const Eigen::Vector2d at = x.head<2>() / x.z();
      const Eigen::Vector2d residual = at - seen, d = (step.head<2>() - at * step.z()) / x.z();
      square += residual.squaredNorm();
      along += residual.dot(d);
      response += d.squaredNorm();
    };
    add(in_left, depth_step, sighting.left);
    if (sighting.right) add(in_right, right_turn_ * depth_step, *sighting.right);
    const double variance = noise_ * noise_;
    return (square - along * along / (variance + response)) / variance /
           (sighting.right ? 2.0 : 1.0);
  }

  std::span<const PointSighting> sightings_;
  const StereoRig& rig_;
  Eigen::Matrix3d right_turn_;
  const StereoPoseOptions& options_;
  double noise_, reference_noise_;
};

std::array<int, 3> DrawSample(std::mt19937& random, int count) {
  std::uniform_int_distribution<int> draw(0, count - 1);
  std::array<int, 3> sample{draw(random), draw(random), draw(random)};
  while (sample[1] == sample[0]) sample[1] = draw(random);
  while (sample[2] == sample[0] || sample[2] == sample[1]) sample[2] = draw(random);
  return sample;
}

std::vector<PointSighting> OfKnownDepth(std::span<const PointSighting> sightings) {
  std::vector<PointSighting> known;
  std::ranges::copy_if(sightings, std::back_inserter(known), [](const PointSighting& sighting) {
    return DepthShare(sighting) <= kKnownShare;
  });
  return known;
}

// The best of many motions by the sightings of a problem, each refined on them.
class BestMotion {
 public:
  explicit BestMotion(const PoseProblem& problem) : problem_(problem) {}

  void Offer(Rigid3 motion) {
    if (problem_.Refine(motion)) OfferAsItIs(motion);
  }

  void OfferAsItIs(const Rigid3& motion) {
    const double cost = problem_.Cost(motion, cost_);
    if (!(cost < cost_)) return;
    cost_ = cost;
    motion_ = motion;
  }

  const std::optional<Rigid3>& motion() const { return motion_; }
  double cost() const { return cost_; }

 private:
  const PoseProblem& problem_;
  std::optional<Rigid3> motion_;
  double cost_ = std::numeric_limits<double>::infinity();
};

// Offers both the motions that three of the sightings tell, which are those of the first.
void OfferSamples(std::span<const PointSighting> sightings, double max_squared, int max_samples,
                  BestMotion& best_of_them, BestMotion& best) {
  const int count = static_cast<int>(sightings.size());
  // Enough samples to meet three inliers once with 99.9 %, given the share that the best explains.
  std::mt19937 random(static_cast<unsigned>(count));
  for (int sample = 0; sample < max_samples; ++sample) {
    const double inlier_share = 1.0 - std::min(1.0, best_of_them.cost() / (count * max_squared));
    const double miss = 1.0 - std::pow(inlier_share, 3);
    if (miss < 1.0 && sample * std::log(std::max(miss, 1e-9)) < std::log(1e-3)) break;
    for (const Rigid3& motion : ThreePointPoses(sightings, DrawSample(random, count))) {
      best_of_them.OfferAsItIs(motion);
      best.OfferAsItIs(motion);
    }
  }
}

// What of a motion the depths tell of the points that agree on it.
class AgreeingDepths {
 public:
  AgreeingDepths(std::span<const PointSighting> sightings, const std::vector<bool>& inliers) {
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (inliers[i]) shares_.push_back(DepthShare(sightings[i]));
    }
  }

  bool TellMoreThanTurns() const {
    return AreSomeNear() || 2 * CountWithin(kKnownShare) >= std::ssize(shares_);
  }

  double MetresSigma() const { return AreSomeNear() || shares_.empty() ? 0.0 : Median(shares_); }

 private:
  bool AreSomeNear() const {
    constexpr int kLeastNear = 6;
    constexpr double kNearShare = 0.1;
    return CountWithin(kNearShare) >= kLeastNear;
  }

  std::ptrdiff_t CountWithin(double share) const {
    return std::ranges::count_if(shares_, [&](double own) { return own <= share; });
  }

  std::vector<double> shares_;
};

}  // namespace

std::optional<StereoPose> EstimateStereoPose(std::span<const PointSighting> sightings,
                                             const StereoRig& rig, std::span<const Rigid3> guesses,
                                             const StereoPoseOptions& options) {
  const std::vector<PointSighting> known = OfKnownDepth(sightings);
  if (std::ssize(sightings) < options.min_inliers || known.size() < 4) return std::nullopt;
  const PoseProblem problem(sightings, rig, options), of_known(known, rig, options);
  BestMotion best(problem), best_of_known(of_known);
  for (const Rigid3& guess : guesses) {
    best.Offer(guess);
    best_of_known.Offer(guess);
  }
  OfferSamples(known, problem.MaxSquared(), options.max_samples, best_of_known, best);
  // Three near points tell a turn so roughly that all far ones may contradict it.
  if (best_of_known.motion()) best.Offer(*best_of_known.motion());
  if (!best.motion()) return std::nullopt;
  Rigid3 motion = *best.motion();
  const auto normal = problem.Refine(motion);
  if (!normal) return std::nullopt;
  StereoPose result = problem.Judge(motion, *normal);
  if (result.inlier_count < options.min_inliers) return std::nullopt;
  const AgreeingDepths depths(sightings, result.inliers);
  if (!depths.TellMoreThanTurns()) return std::nullopt;
  result.metres_sigma = depths.MetresSigma();
  return result;
}

}  // namespace rigmap
