#include "raster/footprint.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/slope_statistics.h"

namespace rigmap {
namespace {

constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
constexpr double kLeastBlockShare = 0.25, kLeastFootprintShare = 0.75;
constexpr double kLeastSigma_m = 1e-4;  // nothing is measured better, no ground is flatter

struct SeenBlock {
  Eigen::Vector3d regressor;  // x east, y north from the middle of the footprint, 1
  double height_m;
  double variance_m2;
};

// Calls `take` with the column and row, counted from the middle, of each block of the circle.
template <class Take>
void ForEachUnder(const GroundBlocks& blocks, double radius_m, Take take) {
  const double reach = radius_m / blocks.block_m;
  const int cells = static_cast<int>(reach);
  for (int r = -cells; r <= cells; ++r) {
    for (int c = -cells; c <= cells; ++c) {
      if (c * c + r * r <= reach * reach) take(c, r);
    }
  }
}

// NaN outside the grid and where nothing was seen.
float HeightAt(const GroundBlocks& blocks, int column, int row) {
  if (column < 0 || column >= blocks.columns || row < 0 || row >= blocks.rows) return kUnseen;
  return blocks.height_m[blocks.Index(column, row)];
}

// Nothing unless enough of the circle was seen.
std::vector<SeenBlock> SeenUnder(const GroundBlocks& blocks, int column, int row, double radius_m) {
  std::vector<SeenBlock> seen;
  int all = 0;
  ForEachUnder(blocks, radius_m, [&](int c, int r) {
    ++all;
    const float height_m = HeightAt(blocks, column + c, row + r);
    if (std::isnan(height_m)) return;
    const double sigma_m =
        std::max<double>(blocks.sigma_m[blocks.Index(column + c, row + r)], kLeastSigma_m);
    seen.push_back({{c * blocks.block_m, -r * blocks.block_m, 1.0}, height_m, sigma_m * sigma_m});
  });
  if (static_cast<double>(seen.size()) < std::max(4.0, kLeastFootprintShare * all)) seen.clear();
  return seen;
}

// Over kBlocksOfStep blocks, so that a step in the middle of one counts in full.
double StepHeight(const GroundBlocks& blocks, int column, int row, double radius_m) {
  double step_m = 0.0;
  ForEachUnder(blocks, radius_m, [&](int c, int r) {
    const float height_m = HeightAt(blocks, column + c, row + r);
    for (int apart = 1; apart <= kBlocksOfStep; ++apart) {
      for (const float other_m : {HeightAt(blocks, column + c + apart, row + r),
                                  HeightAt(blocks, column + c, row + r + apart)}) {
        step_m = std::fmax(step_m, std::abs(other_m - height_m));  // passes over NaN
      }
    }
  });
  return step_m;
}

struct BlockPlane {
  Eigen::Vector3d coefficients;  // gradient east and north, height of the middle
  Eigen::Matrix3d covariance;
};

// Each block weighted by its own variance and what the ground adds.
BlockPlane FitPlane(const std::vector<SeenBlock>& seen, double ground_variance_m2) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  for (const SeenBlock& block : seen) {
    const double weight = 1.0 / (block.variance_m2 + ground_variance_m2);
    information += weight * block.regressor * block.regressor.transpose();
    right_side += weight * block.height_m * block.regressor;
  }
  const Eigen::Matrix3d covariance = information.inverse();
  return {covariance * right_side, covariance};
}

// The variance of the ground about its plane: that of the residuals without the measurements'.
double GroundVariance(const std::vector<SeenBlock>& seen) {
  constexpr double kEvenWeights_m2 = 1e6;  // so much that all blocks count alike
  const Eigen::Vector3d plane = FitPlane(seen, kEvenWeights_m2).coefficients;
  double squares = 0.0, measured = 0.0;
  for (const SeenBlock& block : seen) {
    const double above_m = block.height_m - plane.dot(block.regressor);
    squares += above_m * above_m;
    measured += block.variance_m2;
  }
  const auto count = static_cast<double>(seen.size());
  return std::max(squares / (count - 3.0) - measured / count, kLeastSigma_m * kLeastSigma_m);
}

}  // namespace

GroundBlocks BlocksOf(const std::vector<float>& height_m, const std::vector<float>& sigma_m,
                      int columns, int side, double cell_m) {
  const int rows = static_cast<int>(height_m.size()) / columns;
  GroundBlocks blocks{columns / side, rows / side, side * cell_m, {}, {}};
  for (int row = 0; row < blocks.rows; ++row) {
    for (int column = 0; column < blocks.columns; ++column) {
      double heights = 0.0, variances = 0.0;
      int count = 0;
      for (int i = 0; i < side * side; ++i) {
        const std::size_t cell = static_cast<std::size_t>(row * side + i / side) * columns +
                                 static_cast<std::size_t>(column) * side + i % side;
        if (std::isnan(height_m[cell]) || std::isnan(sigma_m[cell])) continue;
        heights += height_m[cell];
        variances += sigma_m[cell] * sigma_m[cell];
        ++count;
      }
      const bool seen = count > 0 && count >= kLeastBlockShare * side * side;
      blocks.height_m.push_back(seen ? static_cast<float>(heights / count) : kUnseen);
      blocks.sigma_m.push_back(seen ? static_cast<float>(std::sqrt(variances / count)) : kUnseen);
    }
  }
  return blocks;
}

std::optional<FootprintGround> GroundUnder(const GroundBlocks& blocks, int column, int row,
                                           const FootprintLimits& limits) {
  std::vector<SeenBlock> seen = SeenUnder(blocks, column, row, limits.radius_m);
  if (seen.empty()) return std::nullopt;
  const double base_m = seen.front().height_m;  // so that large heights lose no digits
  for (SeenBlock& block : seen) block.height_m -= base_m;
  const BlockPlane plane = FitPlane(seen, GroundVariance(seen));
  if (!plane.covariance.allFinite()) return std::nullopt;
  FootprintGround ground;
  double squares = 0.0;
  for (const SeenBlock& block : seen) {
    const double above_m = block.height_m - plane.coefficients.dot(block.regressor);
    squares += above_m * above_m;
  }
  const Eigen::Vector2d gradient = plane.coefficients.head<2>();
  ground.slope_rad = std::atan(gradient.norm());
  ground.roughness_m = std::sqrt(squares / (static_cast<double>(seen.size()) - 3.0));
  ground.step_height_m = StepHeight(blocks, column, row, limits.radius_m);
  // A small turn of up moves the gradient by its angle times 1 + slope^2 at most.
  const double level_sigma = limits.level_sigma_rad * (1.0 + gradient.squaredNorm());
  const Eigen::Matrix2d of_gradient = plane.covariance.topLeftCorner<2, 2>() +
                                      level_sigma * level_sigma * Eigen::Matrix2d::Identity();
  ground.steeper = ProbabilityOfSteeper(gradient, of_gradient, limits.max_slope_rad);
  return ground;
}

}  // namespace rigmap
