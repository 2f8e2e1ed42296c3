#include "simulation/internal/noise.h"

#include <array>

namespace rigmap {
namespace {

struct Direction {
  float x, y;
};

// Sixteen directions: a gradient costs a look-up, not a cosine.
constexpr std::array<Direction, 16> kDirections{{{1.0f, 0.0f},
                                                 {0.92388f, 0.38268f},
                                                 {0.70711f, 0.70711f},
                                                 {0.38268f, 0.92388f},
                                                 {0.0f, 1.0f},
                                                 {-0.38268f, 0.92388f},
                                                 {-0.70711f, 0.70711f},
                                                 {-0.92388f, 0.38268f},
                                                 {-1.0f, 0.0f},
                                                 {-0.92388f, -0.38268f},
                                                 {-0.70711f, -0.70711f},
                                                 {-0.38268f, -0.92388f},
                                                 {0.0f, -1.0f},
                                                 {0.38268f, -0.92388f},
                                                 {0.70711f, -0.70711f},
                                                 {0.92388f, -0.38268f}}};

const Direction& DirectionAt(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  return kDirections[HashOf(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed) >>
                     28];
}

float Fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }
float FadeSlope(float t) { return 30.0f * t * t * (t * (t - 2.0f) + 1.0f); }

// The component of (x, y, z) along one of the twelve directions to a cube's edges (Perlin 2002).
float Along(std::uint32_t hash, float x, float y, float z) {
  const std::uint32_t edge = ((hash >> 16) * 12u) >> 16;
  const float first = edge < 8 ? x : y, second = edge < 4 ? y : z;
  return ((edge & 1) ? -first : first) + ((edge & 2) ? -second : second);
}

float Mix(float share, float a, float b) { return a + share * (b - a); }

}  // namespace

NoiseValue GradientNoise(double x, double y, std::uint32_t seed) {
  const std::int32_t ix = FloorOf(x), iy = FloorOf(y);
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const Direction &g00 = DirectionAt(ix, iy, seed), &g10 = DirectionAt(ix + 1, iy, seed),
                  &g01 = DirectionAt(ix, iy + 1, seed), &g11 = DirectionAt(ix + 1, iy + 1, seed);
  const float a = g00.x * fx + g00.y * fy, b = g10.x * (fx - 1.0f) + g10.y * fy;
  const float c = g01.x * fx + g01.y * (fy - 1.0f), d = g11.x * (fx - 1.0f) + g11.y * (fy - 1.0f);
  const float u = Fade(fx), v = Fade(fy), twist = a - b - c + d;
  constexpr float kScale = 1.4142f;  // to -1 .. 1
  return {kScale * (a + u * (b - a) + v * (c - a) + u * v * twist),
          kScale * (g00.x + u * (g10.x - g00.x) + v * (g01.x - g00.x) +
                    u * v * (g00.x - g10.x - g01.x + g11.x) + FadeSlope(fx) * (v * twist + b - a)),
          kScale * (g00.y + u * (g10.y - g00.y) + v * (g01.y - g00.y) +
                    u * v * (g00.y - g10.y - g01.y + g11.y) + FadeSlope(fy) * (u * twist + c - a))};
}

float GradientNoise3(double x, double y, double z, std::uint32_t seed) {
  const std::int32_t ix = FloorOf(x), iy = FloorOf(y), iz = FloorOf(z);
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy),
             fz = static_cast<float>(z - iz);
  const auto corner = [&](std::int32_t dx, std::int32_t dy, std::int32_t dz) {
    const std::uint32_t plane = HashOf(static_cast<std::uint32_t>(iz + dz), 0x51ED270Bu, seed);
    return Along(
        HashOf(static_cast<std::uint32_t>(ix + dx), static_cast<std::uint32_t>(iy + dy), plane),
        fx - static_cast<float>(dx), fy - static_cast<float>(dy), fz - static_cast<float>(dz));
  };
  const float u = Fade(fx), v = Fade(fy), w = Fade(fz);
  const float low =
      Mix(v, Mix(u, corner(0, 0, 0), corner(1, 0, 0)), Mix(u, corner(0, 1, 0), corner(1, 1, 0)));
  const float high =
      Mix(v, Mix(u, corner(0, 0, 1), corner(1, 0, 1)), Mix(u, corner(0, 1, 1), corner(1, 1, 1)));
  return Mix(w, low, high);
}

}  // namespace rigmap
