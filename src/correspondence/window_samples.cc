#include "correspondence/internal/window_samples.h"

#include <cmath>
#include <vector>

namespace rigmap {

WindowShape::WindowShape(int columns, int rows) : half_width(columns), half_height(rows) {
  const double across = 0.7 * columns, down = 0.7 * rows;
  for (int y = -rows; y <= rows; ++y) {
    for (int x = -columns; x <= columns; ++x) {
      const double gaussian = std::exp(-0.5 * (x * x / (across * across) + y * y / (down * down)));
      column[count] = static_cast<float>(x);
      row[count] = static_cast<float>(y);
      weight[count++] = static_cast<float>(gaussian);
      weight_sum += gaussian;
      column_moment += gaussian * x * x;
      row_moment += gaussian * y * y;
    }
  }
}

const WindowShape& WindowShapeOf(int half_width, int half_height) {
  static const auto kShapes = [] {
    std::vector<WindowShape> shapes;
    shapes.reserve(kMaxWindowRadius * kMaxWindowRadius);
    for (int i = 0; i < kMaxWindowRadius * kMaxWindowRadius; ++i) {
      shapes.emplace_back(i / kMaxWindowRadius, i % kMaxWindowRadius);
    }
    return shapes;
  }();
  return kShapes[half_width * kMaxWindowRadius + half_height];
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
  across = All(Sum(across) / shape.column_moment);
  down = All(Sum(down) / shape.row_moment);
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
