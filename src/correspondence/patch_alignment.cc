#include "correspondence/patch_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
constexpr int kMaxRadius = 10;
constexpr int kMaxSamples = (2 * kMaxRadius + 1) * (2 * kMaxRadius + 1);

// The template: grey values without their mean plane, of unit variance, and what a change of each
// warp parameter does to them.
struct Template {
  int count = 0;
  double weight_sum = 0.0;
  double moment = 0.0;     // px^2, weighted sum of the squared columns, and so of the rows
  double deviation = 0.0;  // grey levels, before it was normalised
  std::array<double, kMaxSamples> column, row;
  std::array<Eigen::Vector2d, kMaxSamples> offset;
  std::array<double, kMaxSamples> grey, weight;
  std::array<Vector6, kMaxSamples> gradient;
  Matrix6 hessian = Matrix6::Zero();
};

// Normalises `grey` in place; the standard deviation found, or nothing for a flat window. The
// weights are alike to all sides, so that mean and slopes are found one by one.
std::optional<double> Normalise(const Template& window, std::array<double, kMaxSamples>& grey) {
  double square = 0.0;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  for (int i = 0; i < window.count; ++i) {
    plane += window.weight[i] * grey[i] * Eigen::Vector3d(1.0, window.column[i], window.row[i]);
  }
  plane[0] /= window.weight_sum;
  plane.tail<2>() /= window.moment;
  for (int i = 0; i < window.count; ++i) {
    grey[i] -= plane[0] + plane[1] * window.column[i] + plane[2] * window.row[i];
    square += window.weight[i] * grey[i] * grey[i];
  }
  constexpr double kFlatGrey = 1.0;  // below one grey level there is only quantisation
  const double deviation = std::sqrt(square / window.weight_sum);
  if (!(deviation > kFlatGrey)) return std::nullopt;
  for (int i = 0; i < window.count; ++i) grey[i] /= deviation;
  return deviation;
}

bool Inside(const GreyView& image, const Eigen::Vector2i& centre, int radius) {
  return centre.x() >= radius && centre.y() >= radius && centre.x() + radius < image.width &&
         centre.y() + radius < image.height;
}

// What of the gradient only changes plane or deviation is undone by the normalisation: without
// taking it off, steps are too short and the search stops before the place.
void TakeOffBrightness(Template& window) {
  Vector6 mean = Vector6::Zero(), across = Vector6::Zero(), down = Vector6::Zero(),
          along = Vector6::Zero();
  for (int i = 0; i < window.count; ++i) {
    const Vector6 weighted = window.weight[i] * window.gradient[i];
    mean += weighted / window.weight_sum;
    across += window.column[i] / window.moment * weighted;
    down += window.row[i] / window.moment * weighted;
    along += window.grey[i] / window.weight_sum * weighted;
  }
  for (int i = 0; i < window.count; ++i) {
    window.gradient[i] -=
        mean + window.column[i] * across + window.row[i] * down + window.grey[i] * along;
  }
}

// Gaussian, row by row.
const std::array<double, kMaxSamples>& WindowWeights(int radius) {
  static const auto kOfRadius = [] {
    std::array<std::array<double, kMaxSamples>, kMaxRadius> weights{};
    for (int r = 1; r < kMaxRadius; ++r) {
      const double spread = 0.7 * r;
      int i = 0;
      for (int y = -r; y <= r; ++y) {
        for (int x = -r; x <= r; ++x) {
          weights[r][i++] = std::exp(-0.5 * (x * x + y * y) / (spread * spread));
        }
      }
    }
    return weights;
  }();
  return kOfRadius[radius];
}

bool MakeTemplate(const GreyView& source, const Eigen::Vector2i& centre, int radius,
                  Template& window) {
  if (radius > kMaxRadius - 1 || !Inside(source, centre, radius + 1)) return false;
  const std::array<double, kMaxSamples>& weights = WindowWeights(radius);
  const std::uint8_t* middle = source.data + centre.y() * source.stride + centre.x();
  std::array<Eigen::Vector2d, kMaxSamples> slope;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const std::uint8_t* pixel = middle + y * source.stride + x;
      const int i = window.count++;
      window.offset[i] = {x, y};
      window.grey[i] = *pixel;
      window.weight[i] = weights[i];
      window.weight_sum += window.weight[i];
      window.column[i] = x;
      window.row[i] = y;
      window.moment += window.weight[i] * x * x;
      slope[i] = {0.5 * (pixel[1] - pixel[-1]),
                  0.5 * (pixel[source.stride] - pixel[-source.stride])};
    }
  }
  const std::optional<double> deviation = Normalise(window, window.grey);
  if (!deviation) return false;
  window.deviation = *deviation;
  for (int i = 0; i < window.count; ++i) {
    const Eigen::Vector2d g = slope[i] / *deviation;
    const Eigen::Vector2d& u = window.offset[i];
    window.gradient[i] << g.x() * u.x(), g.x() * u.y(), g.y() * u.x(), g.y() * u.y(), g.x(), g.y();
  }
  TakeOffBrightness(window);
  for (int i = 0; i < window.count; ++i) {
    window.hessian += window.weight[i] * window.gradient[i] * window.gradient[i].transpose();
  }
  return true;
}

// Weights of the four pixels around a place `share` beyond the second (Keys 1981, a = -1/2).
std::array<double, 4> CubicWeights(double share) {
  const double t = share, t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
          0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
}

double Cubic(const GreyView& image, const Eigen::Vector2d& x) {
  const int column = static_cast<int>(x.x()), row = static_cast<int>(x.y());
  const std::array<double, 4> across = CubicWeights(x.x() - column);
  const std::array<double, 4> down = CubicWeights(x.y() - row);
  double sum = 0.0;
  if (column > 0 && row > 0 && column + 2 < image.width && row + 2 < image.height) {
    const std::uint8_t* pixels = image.data + (row - 1) * image.stride + column - 1;
    for (int i = 0; i < 4; ++i, pixels += image.stride) {
      sum += down[i] * (across[0] * pixels[0] + across[1] * pixels[1] + across[2] * pixels[2] +
                        across[3] * pixels[3]);
    }
    return sum;
  }
  for (int i = 0; i < 4; ++i) {
    // Beyond the border the nearest pixel is repeated.
    const std::uint8_t* pixels =
        image.data + std::clamp(row + i - 1, 0, image.height - 1) * image.stride;
    const double line = across[0] * pixels[std::max(column - 1, 0)] + across[1] * pixels[column] +
                        across[2] * pixels[column + 1] +
                        across[3] * pixels[std::min(column + 2, image.width - 1)];
    sum += down[i] * line;
  }
  return sum;
}

// Cubic samples of the target under the warp; false where one falls outside. Bilinear ones would
// blur where they fall between pixels, which draws the window aside by up to 0.1 px.
bool Sample(const GreyView& target, const Template& window, const PatchWarp& warp,
            std::array<double, kMaxSamples>& grey) {
  for (int i = 0; i < window.count; ++i) {
    const Eigen::Vector2d x = warp.position + warp.linear * window.offset[i];
    if (!(x.x() >= 0.0 && x.y() >= 0.0 && x.x() < target.width - 1 && x.y() < target.height - 1)) {
      return false;
    }
    grey[i] = Cubic(target, x);
  }
  return true;
}

// warp := warp o (increment)^-1
void Compose(PatchWarp& warp, const Vector6& step) {
  Eigen::Matrix2d linear;
  linear << 1.0 + step(0), step(1), step(2), 1.0 + step(3);
  const Eigen::Matrix2d inverse = linear.inverse();
  warp.position -= warp.linear * (inverse * step.tail<2>());
  warp.linear = warp.linear * inverse;
}

bool Strayed(const PatchWarp& warp, const PatchWarp& start, const PatchAlignmentOptions& options) {
  return !((warp.position - start.position).norm() <= options.max_shift_px) ||
         !((warp.linear - start.linear).cwiseAbs().maxCoeff() <= options.max_stretch);
}

double PositionSigma(const Matrix6& hessian, double residual_square, const Template& window) {
  // The rounding of two images and as much noise: what agrees better does so by chance, and the
  // texture of an edge along itself is nothing but such noise.
  constexpr double kLeastNoiseGrey = 0.6;
  const double least = std::pow(kLeastNoiseGrey / window.deviation, 2);
  const double variance = std::max(residual_square / window.weight_sum, least);
  const Matrix6 covariance = hessian.inverse() * variance;
  const Eigen::Matrix2d position = covariance.bottomRightCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(position, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()(1)));
}

}  // namespace

std::optional<PatchAlignment> AlignPatch(const GreyView& source, const Eigen::Vector2i& centre,
                                         const GreyView& target, const PatchWarp& start,
                                         const PatchAlignmentOptions& options) {
  Template window;
  if (!MakeTemplate(source, centre, options.radius_px, window)) return std::nullopt;
  const Eigen::LDLT<Matrix6> solver(window.hessian);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-8)) return std::nullopt;
  // The bend is not searched.
  for (int i = 0; i < window.count; ++i) window.offset[i] = start.Bent(window.offset[i]);
  PatchAlignment result{.warp = start};
  std::array<double, kMaxSamples> grey;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (!Sample(target, window, result.warp, grey) || !Normalise(window, grey)) return std::nullopt;
    Vector6 gradient = Vector6::Zero();
    double square = 0.0;
    for (int i = 0; i < window.count; ++i) {
      const double residual = grey[i] - window.grey[i];
      gradient += window.weight[i] * residual * window.gradient[i];
      square += window.weight[i] * residual * residual;
    }
    const Vector6 step = solver.solve(gradient);
    Compose(result.warp, step);
    if (Strayed(result.warp, start, options)) return std::nullopt;
    if (step.tail<2>().norm() < options.converged_px) {
      result.correlation = 1.0 - 0.5 * square / window.weight_sum;
      result.sigma_px = PositionSigma(window.hessian, square, window);
      return result;
    }
  }
  return std::nullopt;
}

}  // namespace rigmap
