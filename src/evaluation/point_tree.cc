#include "evaluation/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <stdexcept>

namespace rigmap {
namespace {

constexpr std::size_t kPointsPerLeaf = 16;  // fewer cost memory, more cost time

// nanoflann's result sets, with squared distances; a leaf may offer points that are too far.
struct NearestFound {
  double squared_reach;
  std::optional<std::uint32_t> index;

  double worstDist() const { return squared_reach; }
  bool full() const { return index.has_value(); }
  bool addPoint(double squared, std::uint32_t candidate) {
    if (squared < squared_reach) {
      squared_reach = squared;
      index = candidate;
    }
    return true;
  }
};

struct AllFound {
  double squared_reach;
  std::vector<std::uint32_t> indices;

  double worstDist() const { return squared_reach; }
  bool full() const { return true; }
  bool addPoint(double squared, std::uint32_t candidate) {
    if (squared < squared_reach) indices.push_back(candidate);
    return true;
  }
};

}  // namespace

template <class Point>
struct PointTree<Point>::Index {
  // The points as nanoflann wants to see them.
  struct Source {
    std::span<const Point> points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::uint32_t index, std::size_t axis) const {
      return points[index][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Metric = nanoflann::L2_Simple_Adaptor<double, Source, double, std::uint32_t>;
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<Metric, Source, Point::SizeAtCompileTime, std::uint32_t>;

  explicit Index(std::span<const Point> points)
      : source{points}, tree(Point::SizeAtCompileTime, source, {kPointsPerLeaf}) {}

  Source source;
  Tree tree;
};

template <class Point>
PointTree<Point>::PointTree(std::span<const Point> points) {
  if (points.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("PointTree holds fewer than 2^32 points");
  }
  index_ = std::make_unique<const Index>(points);
}

template <class Point>
PointTree<Point>::~PointTree() = default;

template <class Point>
std::optional<Neighbour> PointTree<Point>::Nearest(const Query& x, double reach) const {
  NearestFound found{reach * reach, std::nullopt};
  index_->tree.findNeighbors(found, x.data(), {});
  if (!found.index) return std::nullopt;
  return Neighbour{*found.index, std::sqrt(found.squared_reach)};
}

template <class Point>
std::vector<std::uint32_t> PointTree<Point>::AllWithin(const Query& x, double reach) const {
  AllFound found{reach * reach, {}};
  index_->tree.findNeighbors(found, x.data(), {});
  std::sort(found.indices.begin(), found.indices.end());
  return found.indices;
}

template class PointTree<Eigen::Vector3f>;
template class PointTree<Eigen::Vector3d>;
template class PointTree<Eigen::Vector2d>;

}  // namespace rigmap
