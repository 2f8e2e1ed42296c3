#include "correspondence/patch_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "correspondence/internal/spline_image.h"
#include "correspondence/internal/window_samples.h"

namespace rigmap {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The template: grey values without their mean plane, of unit variance, and what a change of each
// warp parameter does to them, times the weights.
struct Template {
  explicit Template(const WindowShape& of) : shape(of) {}

  const WindowShape& shape;
  double deviation = 0.0;  // grey levels, before it was normalised
  Samples grey{};
  std::array<Samples, 6> weighted_gradient{};
  Matrix6 hessian = Matrix6::Zero();
};

bool Inside(const GreyView& image, const Eigen::Vector2i& centre, int radius) {
  return centre.x() >= radius && centre.y() >= radius && centre.x() + radius < image.width &&
         centre.y() + radius < image.height;
}

// What of the gradient only changes plane or deviation is undone by the normalisation: without
// taking it off, steps are too short and the search stops before the place.
void TakeOffBrightness(const Template& window, Samples& gradient) {
  TakeOffPlane(window.shape, gradient);
  Four along = Nought();
  for (int i = 0; i < window.shape.count; i += kLanes) {
    const Four weighted = At(window.shape.weight, i) * At(gradient, i);
    along += weighted * At(window.grey, i);
  }
  along = All(Sum(along) / window.shape.weight_sum);
  for (int i = 0; i < window.shape.count; i += kLanes) {
    Set(gradient, i, At(gradient, i) - along * At(window.grey, i));
  }
}

// Weighted gradients and hessian, from the slopes of the grey values (1/px, normalised).
void Linearise(const Samples& across, const Samples& down, Template& window) {
  const WindowShape& shape = window.shape;
  std::array<Samples, 6> gradient;
  for (int i = 0; i < shape.count; i += kLanes) {
    const Four dx = At(across, i), dy = At(down, i), x = At(shape.column, i), y = At(shape.row, i);
    Set(gradient[0], i, dx * x);
    Set(gradient[1], i, dx * y);
    Set(gradient[2], i, dy * x);
    Set(gradient[3], i, dy * y);
    Set(gradient[4], i, dx);
    Set(gradient[5], i, dy);
  }
  for (int a = 0; a < 6; ++a) {
    TakeOffBrightness(window, gradient[a]);
    for (int i = 0; i < shape.count; i += kLanes) {
      Set(window.weighted_gradient[a], i, At(shape.weight, i) * At(gradient[a], i));
    }
    for (int b = 0; b <= a; ++b) {
      Four sum = Nought();
      for (int i = 0; i < shape.count; i += kLanes) {
        sum += At(window.weighted_gradient[a], i) * At(gradient[b], i);
      }
      window.hessian(a, b) = window.hessian(b, a) = Sum(sum);
    }
  }
}

// False where the window leaves the image or is flat.
bool FillTemplate(const GreyView& source, const Eigen::Vector2i& centre, Template& window) {
  const int half_width = window.shape.half_width, half_height = window.shape.half_height;
  const std::uint8_t* middle = source.data + centre.y() * source.stride + centre.x();
  Samples across{}, down{};
  int i = 0;
  for (int y = -half_height; y <= half_height; ++y) {
    const std::uint8_t* pixel = middle + y * source.stride - half_width;
    for (int x = -half_width; x <= half_width; ++x, ++pixel, ++i) {
      window.grey[i] = *pixel;
      across[i] = 0.5F * static_cast<float>(pixel[1] - pixel[-1]);
      down[i] = 0.5F * static_cast<float>(pixel[source.stride] - pixel[-source.stride]);
    }
  }
  const std::optional<double> deviation = Normalise(window.shape, window.grey);
  if (!deviation) return false;
  window.deviation = *deviation;
  for (i = 0; i < window.shape.count; i += kLanes) {
    Set(across, i, At(across, i) * All(1.0 / *deviation));
    Set(down, i, At(down, i) * All(1.0 / *deviation));
  }
  Linearise(across, down, window);
  return true;
}

// Where in the target the samples are looked for, but for the warp that is searched.
struct Offsets {
  Offsets(const WindowShape& shape, const PatchWarp& start) : count(shape.count) {
    for (int i = 0; i < count; ++i) {
      of[i] = start.Bent({shape.column[i], shape.row[i]});
      reach = reach.cwiseMax(of[i].cwiseAbs());
    }
  }

  // That holds them all under the warp.
  Eigen::AlignedBox2d Box(const PatchWarp& warp) const {
    const Eigen::Vector2d from_middle = warp.linear.cwiseAbs() * reach;
    return {warp.position - from_middle, warp.position + from_middle};
  }

  int count;
  std::array<Eigen::Vector2d, kMaxWindowSamples> of;
  Eigen::Vector2d reach = Eigen::Vector2d::Zero();
};

// Samples of the target under the warp; false where one falls outside.
bool Sample(SplineImage& target, const Eigen::AlignedBox2d& frame, const Offsets& offsets,
            const PatchWarp& warp, Samples& grey) {
  const Eigen::AlignedBox2d box = offsets.Box(warp);
  if (!frame.contains(box)) return false;
  target.Cover(box);
  for (int i = 0; i < offsets.count; ++i) {
    grey[i] = target(warp.position + warp.linear * offsets.of[i]);
  }
  return true;
}

// The template as sharp as the target shows it. What a camera blurs, it blurs by the same number of
// pixels in either view, so that a view from nearby is sharper; where a window has more texture on
// one side, that would draw it aside.
class SharpenedTemplate {
 public:
  SharpenedTemplate(const GreyView& source, const Eigen::Vector2i& centre, const Template& window)
      : source_(source), centre_(centre), window_(window), now_(&window.grey) {}

  // Normalised, under that warp; nothing where that leaves it flat. It is made anew where it
  // changes.
  const Samples* Under(const PatchWarp& warp) {
    // Variance of the spot that a point makes in a sharp image, px^2 (Lowe 2004, sec. 3.3), and the
    // change of it that draws a window of twice the texture on one side by 0.0002 px.
    constexpr double kBlur = 0.25, kTold = 0.002;
    const Eigen::Matrix2d inverse = warp.linear.inverse();
    const Eigen::Matrix2d lost =
        kBlur * (Eigen::Matrix2d::Identity() - inverse * inverse.transpose());
    if ((lost - lost_).cwiseAbs().maxCoeff() <= kTold) return now_;
    lost_ = lost;
    Sharpen();
    now_ = Normalise(window_.shape, grey_, kFlatGrey / window_.deviation) ? &grey_ : nullptr;
    return now_;
  }

 private:
  // By half the blur that is lost times the second derivatives.
  void Sharpen() {
    const auto xx = static_cast<float>(0.5 * lost_(0, 0) / window_.deviation),
               xy = static_cast<float>(0.25 * lost_(0, 1) / window_.deviation),
               yy = static_cast<float>(0.5 * lost_(1, 1) / window_.deviation);
    const int stride = source_.stride;
    const std::uint8_t* middle = source_.data + centre_.y() * stride + centre_.x();
    int i = 0;
    const int half_width = window_.shape.half_width, half_height = window_.shape.half_height;
    for (int y = -half_height; y <= half_height; ++y) {
      const std::uint8_t* pixel = middle + y * stride - half_width;
      for (int x = -half_width; x <= half_width; ++x, ++pixel, ++i) {
        const std::uint8_t *above = pixel - stride, *below = pixel + stride;
        const int twice = 2 * pixel[0];
        grey_[i] = window_.grey[i] - xx * static_cast<float>(pixel[1] + pixel[-1] - twice) -
                   xy * static_cast<float>(below[1] - below[-1] - above[1] + above[-1]) -
                   yy * static_cast<float>(*below + *above - twice);
      }
    }
  }

  const GreyView& source_;
  Eigen::Vector2i centre_;
  const Template& window_;
  Samples grey_{};
  const Samples* now_;
  Eigen::Matrix2d lost_ = Eigen::Matrix2d::Zero();
};

// What the samples say of the next step.
struct Residuals {
  Vector6 gradient;
  double square = 0.0;  // weighted sum
};

Residuals ResidualsOf(const Template& window, const Samples& expected, const Samples& grey) {
  std::array<Four, 6> gradient;
  gradient.fill(Nought());
  Four square = Nought();
  for (int i = 0; i < window.shape.count; i += kLanes) {
    const Four residual = At(grey, i) - At(expected, i);
    square += At(window.shape.weight, i) * residual * residual;
    for (int a = 0; a < 6; ++a) {
      gradient[a] += At(window.weighted_gradient[a], i) * residual;
    }
  }
  Residuals residuals{.square = Sum(square)};
  for (int a = 0; a < 6; ++a) residuals.gradient[a] = Sum(gradient[a]);
  return residuals;
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
  const double variance = std::max(residual_square / window.shape.weight_sum, least);
  const Matrix6 covariance = hessian.inverse() * variance;
  const Eigen::Matrix2d position = covariance.bottomRightCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(position, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()(1)));
}

}  // namespace

std::optional<PatchAlignment> AlignPatch(const GreyView& source, const Eigen::Vector2i& centre,
                                         const GreyView& target, const PatchWarp& start,
                                         const PatchAlignmentOptions& options) {
  const int half_width = options.half_width_px, half_height = options.half_height_px;
  const int radius = std::max(half_width, half_height);
  if (radius >= kMaxWindowRadius || !Inside(source, centre, radius + 1)) return std::nullopt;
  Template window(WindowShapeOf(half_width, half_height));
  if (!FillTemplate(source, centre, window)) return std::nullopt;
  const Eigen::LDLT<Matrix6> solver(window.hessian);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-8)) return std::nullopt;
  const Offsets offsets(window.shape, start);  // the bend is not searched
  SplineImage spline(target);
  // As far as a pixel follows.
  const Eigen::AlignedBox2d frame(Eigen::Vector2d::Zero(),
                                  Eigen::Vector2d(target.width - 1.001, target.height - 1.001));
  SharpenedTemplate sharpened(source, centre, window);
  PatchAlignment result{.warp = start};
  Samples grey{};
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (!Sample(spline, frame, offsets, result.warp, grey) || !Normalise(window.shape, grey)) {
      return std::nullopt;
    }
    const Samples* expected = sharpened.Under(result.warp);
    if (!expected) return std::nullopt;
    const Residuals residuals = ResidualsOf(window, *expected, grey);
    const Vector6 step = solver.solve(residuals.gradient);
    Compose(result.warp, step);
    if (Strayed(result.warp, start, options)) return std::nullopt;
    if (step.tail<2>().norm() < options.converged_px) {
      result.correlation = 1.0 - 0.5 * residuals.square / window.shape.weight_sum;
      result.sigma_px = PositionSigma(window.hessian, residuals.square, window);
      return result;
    }
  }
  return std::nullopt;
}

}  // namespace rigmap
