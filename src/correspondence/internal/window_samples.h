// The samples of a window, four at a time. Of this room only.
#pragma once

#include <array>
#include <opencv2/core/hal/intrin.hpp>
#include <optional>

namespace rigmap {

inline constexpr int kMaxWindowRadius = 10;
inline constexpr int kMaxWindowSamples = (2 * kMaxWindowRadius + 1) * (2 * kMaxWindowRadius + 1);

// Four samples at a time, whatever the processor could do: results are the same on all of them.
using Four = cv::v_float32x4;
inline constexpr int kLanes = Four::nlanes;
using Samples = std::array<float, (kMaxWindowSamples + kLanes - 1) / kLanes * kLanes>;

inline Four At(const Samples& samples, int i) { return cv::v_load(samples.data() + i); }
inline void Set(Samples& samples, int i, const Four& values) {
  cv::v_store(samples.data() + i, values);
}
inline Four Nought() { return cv::v_setzero_f32(); }
inline Four All(double value) { return cv::v_setall_f32(static_cast<float>(value)); }
inline double Sum(const Four& values) { return cv::v_reduce_sum(values); }

// What only depends on the size of a window, px to either side of its centre: Gaussian weights,
// alike to left and right and to above and below. Row by row, and up to the next multiple of four
// of no weight.
struct WindowShape {
  WindowShape(int columns, int rows);

  int half_width = 0, half_height = 0;  // px
  int count = 0;
  double weight_sum = 0.0;
  double column_moment = 0.0, row_moment = 0.0;  // px^2, weighted sums of the squares
  Samples column{}, row{}, weight{};
};

// Made once; both from 1 to less than kMaxWindowRadius.
const WindowShape& WindowShapeOf(int half_width, int half_height);

// Takes the weighted mean plane off `samples`.
void TakeOffPlane(const WindowShape& shape, Samples& samples);

inline constexpr double kFlatGrey = 1.0;  // below one grey level there is only quantisation

// Takes the mean plane off grey values and gives the rest unit variance; the standard deviation
// found, or nothing for a window that is flatter than `flat`.
std::optional<double> Normalise(const WindowShape& shape, Samples& grey, double flat = kFlatGrey);

}  // namespace rigmap
