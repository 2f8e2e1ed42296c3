// What the sparse model says of matches and residuals, for tables and drawings.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "core/stamp.h"
#include "scene/sparse_model.h"

namespace rigmap {

struct ImageStatistics {
  std::size_t points = 0;             // sparse points seen in the left image
  std::optional<double> residual_px;  // median distance in it, of ten points or more
};

// Mean residual of the left images' observations in one cell of the image, px.
struct ResidualCell {
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();  // measured less projected
  std::size_t count = 0;
};

inline constexpr int kResidualColumns = 12, kResidualRows = 9;

struct SparseStatistics {
  std::map<StampNs, ImageStatistics> images;  // by the stamp of the left image's name
  std::map<int, std::size_t> tracks;          // frames that show a point -> how many points
  std::size_t points = 0, observations = 0;
  std::array<ResidualCell, kResidualColumns * kResidualRows> field{};  // row by row
  int width = 0, height = 0;                                           // of the left image, px
  // How many points two groups of frames have in common, frames in order of time in at most
  // kMatrixSide groups of equally many; row by row.
  int matrix_side = 0, frames_per_group = 1;
  std::vector<std::size_t> matrix;
};

// The left camera of a model; null where it has none.
const Camera* LeftCameraOf(const SparseModel& model);

SparseStatistics StatisticsOf(const SparseModel& model);

// How many points the median left image shows; 0 without any.
double MedianPointsOfImages(const SparseStatistics& statistics);

}  // namespace rigmap
