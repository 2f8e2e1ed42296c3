#include "simulation/internal/pixel_footprint.h"

#include <algorithm>
#include <cmath>

namespace rigmap {

int PixelFootprint::Samples() const {
  constexpr int kMost = 4;
  return std::clamp(static_cast<int>(along_m / (1.4f * across_m) + 0.5f), 1, kMost);
}

PixelFootprint FootprintOn(const Eigen::Vector3f& direction, const RaySteps& steps,
                           const Eigen::Vector3f& normal, float distance_m) {
  const float facing = std::min(normal.dot(direction), -0.03f);
  std::array<Eigen::Vector3f, 2> spans;
  for (int i = 0; i < 2; ++i) {
    spans[i] = distance_m * (steps[i] - normal.dot(steps[i]) / facing * direction);
  }
  // Axes of the ellipse that the two spans make: half the angle whose double has this sine and
  // cosine.
  const float a = spans[0].squaredNorm(), b = spans[0].dot(spans[1]), c = spans[1].squaredNorm();
  const float twice_cos = a - c, twice_sin = 2.0f * b;
  const float length = std::max(std::sqrt(twice_cos * twice_cos + twice_sin * twice_sin), 1e-30f);
  const float cosine = std::sqrt(std::max(0.0f, 0.5f + 0.5f * twice_cos / length)),
              sine = std::copysign(std::sqrt(std::max(0.0f, 0.5f - 0.5f * twice_cos / length)),
                                   twice_sin);
  const Eigen::Vector3f major = cosine * spans[0] + sine * spans[1],
                        minor = cosine * spans[1] - sine * spans[0];
  return {major, major.norm(), std::max(minor.norm(), 1e-6f)};
}

}  // namespace rigmap
