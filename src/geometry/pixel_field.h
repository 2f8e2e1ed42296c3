// Displacements of an image's pixels.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace rigmap {

// Nodes in rows over an image, from edge to edge, one more each way than there are cells.
struct NodeGrid {
  int columns = 1, rows = 1;         // cells
  double width = 0.0, height = 0.0;  // of the image, px

  // The four nodes about a pixel (row by row, from the upper left one) and what each counts for.
  // Pixels outside of the image count as the nearest on its edge.
  struct Support {
    std::array<int, 4> node{};
    std::array<double, 4> weight{};
  };
  Support At(const Eigen::Vector2d& pixel) const;
  int Nodes() const { return (columns + 1) * (rows + 1); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(columns, rows, width, height);
  }
};

// Bilinear between the nodes.
struct PixelField {
  NodeGrid grid;
  std::vector<Eigen::Vector2d> displacements;  // of the nodes, px

  Eigen::Vector2d At(const Eigen::Vector2d& pixel) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(grid, displacements);
  }
};

}  // namespace rigmap
