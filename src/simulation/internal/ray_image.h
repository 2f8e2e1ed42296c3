// The rays of one image, and what a lens makes of those around a pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace rigmap {

// What a ray meets.
struct RaySample {
  static constexpr std::uint32_t kNoThing = 0xFFFFFFFFu;

  Eigen::Vector3f colour = Eigen::Vector3f::Zero();  // radiance: red, green, blue
  float nearness = 0.0f;                             // 1 / distance
  std::uint32_t thing = kNoThing;  // differs between things that an edge may lie between
};

// The lens spreads a point before pixels sample it, and what is finer than two pixels with it. Were
// that sampled, it would move with the pixels instead of with the ground. So each row of pixels is
// made of rows of rays half a pixel apart, by a Gaussian of 0.5 px. Along a row a ray stands for a
// pixel and a half.
class RayImage {
 public:
  static constexpr int kRaysPerRow = 2;
  static constexpr float kRayWidth_px = 1.5f, kRayHeight_px = 1.0f;

  explicit RayImage(const cv::Size& size);

  int RayRows() const { return kRaysPerRow * size_.height; }
  // Where a row of rays lies, in rows of pixels.
  static float RowOf(int ray_row) {
    return (static_cast<float>(ray_row) + 0.5f) / kRaysPerRow - 0.5f;
  }
  std::span<RaySample> Row(int ray_row);

  Eigen::Vector3f ThroughLens(int column, int row) const;
  // An edge passes where the neighbours are of other things, or do not lie on one plane.
  bool IsAtEdge(int column, int row) const;

 private:
  std::size_t IndexOf(int column, int ray_row) const {
    return static_cast<std::size_t>(ray_row) * size_.width + column;
  }
  bool IsEdge(std::size_t at, std::size_t step) const;

  cv::Size size_;
  std::vector<RaySample> samples_;
};

// From a pixel's centre, right and down, px: rays that stand for all around it where an edge
// crosses. As far spread as the lens's spot, no two in a row or column.
inline constexpr float kRayShare = 0.125f;
inline constexpr std::array<std::array<float, 2>, 8> kRaysAround{{{0.125f, -0.375f},
                                                                  {-0.125f, 0.375f},
                                                                  {0.625f, 0.125f},
                                                                  {-0.375f, -0.625f},
                                                                  {-0.625f, 0.625f},
                                                                  {-0.875f, -0.125f},
                                                                  {0.375f, 0.875f},
                                                                  {0.875f, -0.875f}}};

}  // namespace rigmap
