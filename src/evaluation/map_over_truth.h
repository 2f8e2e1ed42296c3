// A map laid over the truth.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/map_truth.h"
#include "evaluation/point_tree.h"
#include "evaluation/trajectory_metrics.h"

namespace rigmap {

// The points of a binary little-endian PLY as float, as this project writes them; 12 bytes each.
// Throws DataError naming the file for anything else, and for coordinates that are not finite.
std::vector<Eigen::Vector3f> ReadMapPoints(const std::filesystem::path& ply);

// What the same file states of its points (`sigma`), m; empty where it states nothing.
std::vector<float> ReadMapSigmas(const std::filesystem::path& ply);

// truth_from_world by which the estimated poses come to lie best on the true ones (least squares
// over matched poses, within options.max_dt_s). No scale: a wrong one must show in the map. Each
// pose stands for its centre and for the ends of its axes, 2 m long, so that orientations count and
// a straight path leaves no roll about itself free. Nothing for fewer than three matched poses.
std::optional<Rigid3> AlignWithTruth(std::span<const TumPose> estimate,
                                     std::span<const TumPose> truth,
                                     const EvaluationOptions& options = {});

// What both judgements search: map, true surface and path, each in a tree. All coordinates in and
// out are in the truth's frame, in metres. Takes about 30 bytes a point of the map, and 15 a point
// of the surface besides the truth itself. Queries may come from several threads at once.
class MapOverTruth {
 public:
  // `truth` must outlive this. The map may be empty, its points must be finite. A sigma for each
  // of them, m, or none at all.
  MapOverTruth(std::vector<Eigen::Vector3f> x_in_world, const Rigid3& truth_from_world,
               const MapTruth& truth, std::vector<float> sigmas_m = {});

  const MapTruth& truth() const { return truth_; }
  std::size_t size() const { return x_in_world_.size(); }  // of the map
  Eigen::Vector3d MapPoint(std::size_t index) const;
  bool has_sigmas() const { return !sigmas_m_.empty(); }
  double SigmaOfMapPoint(std::size_t index) const { return sigmas_m_[index]; }

  // The nearest point if nearer than `reach_m`.
  std::optional<Neighbour> NearestOfMap(const Eigen::Vector3d& x, double reach_m) const;
  std::optional<Neighbour> NearestOfSurface(const Eigen::Vector3d& x, double reach_m) const;
  // Indices of the map's points nearer than `reach_m`, in rising order.
  std::vector<std::uint32_t> MapPointsWithin(const Eigen::Vector3d& x, double reach_m) const;
  // Horizontal distance from the true path, 20 points to a step; nothing if not below `reach_m`.
  std::optional<double> FromPath(const Eigen::Vector3d& x, double reach_m) const;

 private:
  Eigen::Vector3d InWorld(const Eigen::Vector3d& x_in_truth) const;

  const MapTruth& truth_;
  std::vector<Eigen::Vector3f> x_in_world_;
  std::vector<float> sigmas_m_;
  Eigen::Matrix3d truth_from_world_rotation_;
  Eigen::Vector3d world_in_truth_;
  std::vector<Eigen::Vector2d> path_;
  std::optional<PointTree<Eigen::Vector3f>> map_tree_, surface_tree_;
  std::optional<PointTree<Eigen::Vector2d>> path_tree_;
};

}  // namespace rigmap
