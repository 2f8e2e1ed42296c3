#include "raster/internal/relief_shading.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

constexpr double kSurroundingsGrains = 12.0;  // sigma of the mean height: half a stone
constexpr double kFullReliefGrains = 6.0;     // above or below the surroundings
constexpr float kStrength = 0.45F;            // share of the brightness at full relief

// Metres above the mean of the seen cells around.
cv::Mat1f Relief(const SurfaceGrid& surface, double grain_px) {
  cv::Mat1f height(surface.rows, surface.columns), seen(surface.rows, surface.columns);
  for (int row = 0; row < surface.rows; ++row) {
    for (int column = 0; column < surface.columns; ++column) {
      const bool holds = surface.Holds(column, row);
      seen(row, column) = holds ? 1.0F : 0.0F;
      height(row, column) = holds ? surface.height_m[surface.Index(column, row)] : 0.0F;
    }
  }
  const double sigma_px = std::clamp(kSurroundingsGrains * grain_px, 3.0, 40.0);
  cv::Mat1f mean, weight;
  cv::GaussianBlur(height, mean, {}, sigma_px, sigma_px, cv::BORDER_CONSTANT);
  cv::GaussianBlur(seen, weight, {}, sigma_px, sigma_px, cv::BORDER_CONSTANT);
  return height - mean / cv::max(weight, 1e-6F);
}

}  // namespace

void DrawShaded(const SurfaceGrid& surface, double grain_m, double px_per_m, cv::Mat3b picture) {
  const cv::Mat1f relief_m = Relief(surface, grain_m * px_per_m);
  const auto full_m = static_cast<float>(kFullReliefGrains * grain_m);
  for (int row = 0; row < surface.rows; ++row) {
    for (int column = 0; column < surface.columns; ++column) {
      if (!surface.Holds(column, row)) continue;
      const float relief = std::clamp(relief_m(row, column) / full_m, -1.0F, 1.0F);
      const auto& rgb = surface.rgb[surface.Index(column, row)];
      const float brightness = 1.0F + kStrength * relief;
      picture(row, column) = {cv::saturate_cast<std::uint8_t>(brightness * rgb[2]),
                              cv::saturate_cast<std::uint8_t>(brightness * rgb[1]),
                              cv::saturate_cast<std::uint8_t>(brightness * rgb[0])};
    }
  }
}

}  // namespace rigmap
