#include "correspondence/internal/window_samples.h"

#include <cmath>
#include <vector>

namespace rigmap {

WindowShape::WindowShape(int radius) {
  const double spread = 0.7 * radius;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const double gaussian = std::exp(-0.5 * (x * x + y * y) / (spread * spread));
      column[count] = static_cast<float>(x);
      row[count] = static_cast<float>(y);
      weight[count++] = static_cast<float>(gaussian);
      weight_sum += gaussian;
      moment += gaussian * x * x;
    }
  }
}

const WindowShape& WindowShapeOf(int radius) {
  static const auto kShapes = [] {
    std::vector<WindowShape> shapes;
    shapes.reserve(kMaxWindowRadius);
    for (int r = 0; r < kMaxWindowRadius; ++r) shapes.emplace_back(r);
    return shapes;
  }();
  return kShapes[radius];
}

// The weights are alike to all sides, so that mean and slopes are found one by one.
void TakeOffPlane(const WindowShape& shape, Samples& samples) {
  Four mean = Nought(), across = Nought(), down = Nought();
  for (int i = 0; i < shape.count; i += kLanes) {
    const Four weighted = At(shape.weight, i) * At(samples, i);
    mean += weighted;
    across += weighted * At(shape.column, i);
    down += weighted * At(shape.row, i);
  }
  mean = All(Sum(mean) / shape.weight_sum);
  across = All(Sum(across) / shape.moment);
  down = All(Sum(down) / shape.moment);
  for (int i = 0; i < shape.count; i += kLanes) {
    const Four tilt = mean + across * At(shape.column, i) + down * At(shape.row, i);
    Set(samples, i, At(samples, i) - tilt);
  }
}

std::optional<double> Normalise(const WindowShape& shape, Samples& grey, double flat) {
  TakeOffPlane(shape, grey);
  Four square = Nought();
  for (int i = 0; i < shape.count; i += kLanes) {
    const Four value = At(grey, i);
    square += At(shape.weight, i) * value * value;
  }
  const double deviation = std::sqrt(Sum(square) / shape.weight_sum);
  if (!(deviation > flat)) return std::nullopt;
  for (int i = 0; i < shape.count; i += kLanes) {
    Set(grey, i, At(grey, i) * All(1.0 / deviation));
  }
  return deviation;
}

}  // namespace rigmap
