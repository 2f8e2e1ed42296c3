// Nearest neighbours among points. The only place that knows the library of k-d trees.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rigmap {

struct Neighbour {
  std::uint32_t index = 0;
  double distance = 0.0;
};

// A k-d tree over Eigen::Vector3f, Vector3d or Vector2d; distances are taken in double precision.
// Refers to the points, which must outlive it and stay; takes about 15 bytes a point itself.
// Queries may come from several threads at once.
template <class Point>
class PointTree {
 public:
  using Query = Eigen::Matrix<double, Point::SizeAtCompileTime, 1>;

  // Points must be finite. Throws std::length_error for 2^32 points or more.
  explicit PointTree(std::span<const Point> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  // The nearest point, if nearer than `reach` (which may be infinite).
  std::optional<Neighbour> Nearest(const Query& x, double reach) const;
  // Indices of all points nearer than `reach`, in rising order.
  std::vector<std::uint32_t> AllWithin(const Query& x, double reach) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

extern template class PointTree<Eigen::Vector3f>;
extern template class PointTree<Eigen::Vector3d>;
extern template class PointTree<Eigen::Vector2d>;

}  // namespace rigmap
