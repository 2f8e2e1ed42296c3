#include "evaluation/map_over_truth.h"

#include <tbb/parallel_invoke.h>

#include "evaluation/matched_poses.h"
#include "export/ply_rows.h"
#include "geometry/alignment.h"

namespace rigmap {
namespace {

// m; as far as the cameras see the ground well, so that an error of orientation weighs as much as
// the error of the map that it makes.
constexpr double kAxisLength_m = 2.0;

constexpr int kPathPointsPerStep = 20;  // a step of the rover is at most a metre: 5 cm

std::vector<Eigen::Vector3d> CentresAndAxes(const std::vector<Rigid3>& world_from_body) {
  std::vector<Eigen::Vector3d> points;
  for (const Rigid3& pose : world_from_body) {
    points.push_back(pose.translation);
    for (int axis = 0; axis < 3; ++axis) {
      points.push_back(pose * (kAxisLength_m * Eigen::Vector3d::Unit(axis)));
    }
  }
  return points;
}

std::vector<Eigen::Vector2d> DensePath(const std::vector<TumPose>& poses) {
  std::vector<Eigen::Vector2d> path;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Eigen::Vector2d from = poses[i].world_from_body.translation.head<2>();
    const Eigen::Vector2d to = poses[i + 1].world_from_body.translation.head<2>();
    for (int k = 0; k < kPathPointsPerStep; ++k) {
      path.push_back(from + k * ((to - from) / kPathPointsPerStep));
    }
  }
  if (!poses.empty()) path.push_back(poses.back().world_from_body.translation.head<2>());
  return path;
}

}  // namespace

std::vector<Eigen::Vector3f> ReadMapPoints(const std::filesystem::path& ply) {
  PlyRows rows(ply);
  const auto x = rows.At({"x", "y", "z"});
  std::vector<Eigen::Vector3f> points;
  points.reserve(rows.size());
  for (std::uint64_t i = 0; i < rows.size(); ++i) {
    rows.Next();
    points.push_back(rows.FinitePoint(x));
  }
  return points;
}

std::vector<float> ReadMapSigmas(const std::filesystem::path& ply) {
  PlyRows rows(ply);
  const PlyProperty* sigma = rows.Find("sigma");
  std::vector<float> sigmas_m;
  if (!sigma) return sigmas_m;
  sigmas_m.reserve(rows.size());
  for (std::uint64_t i = 0; i < rows.size(); ++i) {
    sigmas_m.push_back(static_cast<float>(PlyValue(*sigma, rows.Next())));
  }
  return sigmas_m;
}

std::optional<Rigid3> AlignWithTruth(std::span<const TumPose> estimate,
                                     std::span<const TumPose> truth,
                                     const EvaluationOptions& options) {
  const MatchedPoses matched =
      MatchPoses(InOrderOfTime(estimate), InOrderOfTime(truth), options.max_dt_s, Tie::kEarlier);
  if (matched.size() < kMinMatches) return std::nullopt;
  const Sim3 truth_from_world =
      AlignPoints(CentresAndAxes(matched.estimate), CentresAndAxes(matched.truth), false);
  return Rigid3{truth_from_world.rotation, truth_from_world.translation};
}

MapOverTruth::MapOverTruth(std::vector<Eigen::Vector3f> x_in_world, const Rigid3& truth_from_world,
                           const MapTruth& truth, std::vector<float> sigmas_m)
    : truth_(truth),
      x_in_world_(std::move(x_in_world)),
      sigmas_m_(std::move(sigmas_m)),
      truth_from_world_rotation_(truth_from_world.rotation.toRotationMatrix()),
      world_in_truth_(truth_from_world.translation),
      path_(DensePath(truth.path)) {
  path_tree_.emplace(path_);
  tbb::parallel_invoke([&] { map_tree_.emplace(x_in_world_); },
                       [&] { surface_tree_.emplace(truth_.surface.x_in_truth); });
}

Eigen::Vector3d MapOverTruth::MapPoint(std::size_t index) const {
  return truth_from_world_rotation_ * x_in_world_[index].cast<double>() + world_in_truth_;
}

Eigen::Vector3d MapOverTruth::InWorld(const Eigen::Vector3d& x_in_truth) const {
  return truth_from_world_rotation_.transpose() * (x_in_truth - world_in_truth_);
}

std::optional<Neighbour> MapOverTruth::NearestOfMap(const Eigen::Vector3d& x,
                                                    double reach_m) const {
  return map_tree_->Nearest(InWorld(x), reach_m);
}

std::optional<Neighbour> MapOverTruth::NearestOfSurface(const Eigen::Vector3d& x,
                                                        double reach_m) const {
  return surface_tree_->Nearest(x, reach_m);
}

std::vector<std::uint32_t> MapOverTruth::MapPointsWithin(const Eigen::Vector3d& x,
                                                         double reach_m) const {
  return map_tree_->AllWithin(InWorld(x), reach_m);
}

std::optional<double> MapOverTruth::FromPath(const Eigen::Vector3d& x, double reach_m) const {
  const auto nearest = path_tree_->Nearest(x.head<2>(), reach_m);
  return nearest ? std::optional<double>(nearest->distance) : std::nullopt;
}

}  // namespace rigmap
