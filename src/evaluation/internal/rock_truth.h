// A true rock and what stands around it, prepared for judging how a map shows them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/map_truth.h"
#include "evaluation/point_tree.h"

namespace rigmap {

// Points of a true surface and a tree over them; metres, in the truth's frame.
struct SearchedSurface {
  SearchedSurface(const TrueSurface& surface, const std::vector<std::uint32_t>& indices);

  std::size_t size() const { return x.size(); }

  std::vector<Eigen::Vector3d> x, normal;
  PointTree<Eigen::Vector3d> tree;
};

// What of a rock can be judged without taking sand for it: its visible points that lie 5 cm or more
// from anything else, in cubes of 5 cm, the patches.
struct RockCore {
  // Per point of the rock's surroundings: the patch it belongs to; nothing outside the core.
  std::vector<std::optional<std::uint32_t>> patch_of;
  std::vector<double> patch_area;  // 1: a patch that the surface crosses fully; less: its corner
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // mean of the core's points
};

// Indices into the true surface, each list in rising order.
struct RockPoints {
  std::vector<std::uint32_t> all;    // within 55 cm of the square that holds the rock
  std::vector<std::uint32_t> own;    // those that belong to the rock
  std::vector<std::uint32_t> shown;  // and can be seen
};

// For each rock of the truth the points of the surface that are rock and nearest its centre in
// plan: rocks that touch have their own points each.
std::vector<std::vector<std::uint32_t>> PointsOfRocks(const MapTruth& truth);

struct RockTruth {
  // `own`: the entry of PointsOfRocks for the rock.
  RockTruth(const TrueRock& rock, const TrueSurface& surface, std::span<const std::uint32_t> own);

  TrueRock rock;
  SearchedSurface all, own, shown;
  RockCore core;

 private:
  RockTruth(const TrueRock& rock, const TrueSurface& surface, const RockPoints& points);
};

}  // namespace rigmap
