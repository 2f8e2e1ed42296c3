// Grey values between pixels. Of this room only.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "correspondence/internal/window_samples.h"
#include "correspondence/patch_alignment.h"

namespace rigmap {

// Weights of the four pixels around a place `share` beyond the second (Keys 1981, a = -1/2).
inline Four CubicWeights(float share) {
  const Four t = cv::v_setall_f32(share);
  Four weights(-0.5F, 1.5F, -1.5F, 0.5F);
  weights = weights * t + Four(1.0F, -2.5F, 2.0F, -0.5F);
  weights = weights * t + Four(-0.5F, 0.0F, 0.5F, 0.0F);
  return weights * t + Four(0.0F, 1.0F, 0.0F, 0.0F);
}

inline Four FourPixels(const std::uint8_t* pixels) {
  // OpenCV reads them as one number.
  alignas(std::int32_t) std::array<std::uint8_t, kLanes> aligned;
  std::memcpy(aligned.data(), pixels, kLanes);
  return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_load_expand_q(aligned.data())));
}

inline float Cubic(const GreyView& image, const Eigen::Vector2d& x) {
  const int column = static_cast<int>(x.x()), row = static_cast<int>(x.y());
  const Four across = CubicWeights(static_cast<float>(x.x() - column));
  const Four down = CubicWeights(static_cast<float>(x.y() - row));
  const auto weighted = [&](const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                            const std::uint8_t* d) {
    Four sum = cv::v_broadcast_element<0>(down) * FourPixels(a);
    sum += cv::v_broadcast_element<1>(down) * FourPixels(b);
    sum += cv::v_broadcast_element<2>(down) * FourPixels(c);
    sum += cv::v_broadcast_element<3>(down) * FourPixels(d);
    return cv::v_reduce_sum(across * sum);
  };
  if (column > 0 && row > 0 && column + 2 < image.width && row + 2 < image.height) {
    const std::uint8_t* pixels = image.data + (row - 1) * image.stride + column - 1;
    return weighted(pixels, pixels + image.stride, pixels + 2 * image.stride,
                    pixels + 3 * image.stride);
  }
  // Beyond the border the nearest pixel is repeated.
  std::array<std::array<std::uint8_t, kLanes>, kLanes> pixels{};
  for (int i = 0; i < kLanes; ++i) {
    const std::uint8_t* line =
        image.data + std::clamp(row + i - 1, 0, image.height - 1) * image.stride;
    for (int j = 0; j < kLanes; ++j) {
      pixels[i][j] = line[std::clamp(column + j - 1, 0, image.width - 1)];
    }
  }
  return weighted(pixels[0].data(), pixels[1].data(), pixels[2].data(), pixels[3].data());
}

}  // namespace rigmap
