#include "simulation/internal/materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

const Eigen::Vector3f kDrySand(0.395f, 0.352f, 0.287f);

// Weight of structures of a length for samples of an extent: none below two samples a length.
float Shown(float length_m, float extent_m) {
  const float t = std::clamp((length_m / extent_m - 1.2f) / 1.6f, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

struct Octave {
  float length_m;
  float tone;    // amplitude in the albedo
  float relief;  // amplitude of height over length
};

// {length, tone}
constexpr std::array<std::array<float, 2>, 6> kPatches{{{5.3f, 0.08f},
                                                        {1.7f, 0.10f},
                                                        {0.61f, 0.08f},
                                                        {0.23f, 0.07f},
                                                        {0.094f, 0.08f},
                                                        {0.047f, 0.09f}}};
constexpr std::array<Octave, 4> kGrains{{{0.022f, 0.08f, 0.09f},
                                         {0.0105f, 0.10f, 0.12f},
                                         {0.0052f, 0.10f, 0.11f},
                                         {0.0024f, 0.10f, 0.07f}}};

struct Specks {
  float cell_m, share, radius_m;  // one speck at most in a cell
};
constexpr std::array<Specks, 2> kSpecks{{{0.009f, 0.22f, 0.0013f}, {0.031f, 0.25f, 0.0030f}}};

// Bits of shell (light) and of seaweed and stone (dark): a factor on the albedo.
float SpeckTone(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed) {
  float tone = 0.0f;
  for (const Specks& specks : kSpecks) {
    const float radius2 = specks.radius_m * specks.radius_m,
                blurred2 = radius2 + 0.2f * extent_m * extent_m;
    const float strength = radius2 / blurred2;
    if (strength < 0.04f) continue;
    const double x = position.x() / specks.cell_m, y = position.y() / specks.cell_m;
    const std::int32_t column = FloorOf(x), row = FloorOf(y);
    const std::uint32_t hash =
        HashOf(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row), ++seed);
    if (UnitOf(hash) > specks.share) continue;
    const std::uint32_t more = HashOf(hash, 1, seed);
    const float at_x = 0.25f + 0.5f * static_cast<float>(more & 0xFFFF) / 65535.0f,
                at_y = 0.25f + 0.5f * static_cast<float>(more >> 16) / 65535.0f;
    const float dx = (static_cast<float>(x - column) - at_x) * specks.cell_m,
                dy = (static_cast<float>(y - row) - at_y) * specks.cell_m;
    const float depth = (hash & 1) ? -0.75f : ((hash & 6) ? -0.5f : 0.7f);
    tone += depth * strength * std::exp(-0.5f * (dx * dx + dy * dy) / blurred2 * 1.4f);
  }
  return tone;
}

}  // namespace

float SandTone(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed) {
  float tone = 0.0f;
  for (const auto& [length_m, depth] : kPatches) {
    const float shown = Shown(length_m, extent_m);
    if (shown == 0.0f) break;
    tone += shown * depth *
            GradientNoise(position.x() / length_m, position.y() / length_m, seed++).value;
  }
  return tone;
}

Appearance SandAppearance(const Eigen::Vector2d& position, float extent_m, float tone,
                          float contrast, std::uint32_t seed) {
  Appearance appearance;
  const float tint = 0.25f * contrast * tone;
  seed += 100;
  Eigen::Vector2d turned = position;
  Eigen::Vector2f turn(1.0f, 0.0f);  // cosine and sine that lead back
  for (const Octave& octave : kGrains) {
    const float shown = Shown(octave.length_m, extent_m);
    if (shown == 0.0f) break;
    // Each octave is turned against the last, or their common lattice would show.
    turned =
        Eigen::Vector2d(0.8 * turned.x() + 0.6 * turned.y(), 0.8 * turned.y() - 0.6 * turned.x());
    turn = Eigen::Vector2f(0.8f * turn.x() - 0.6f * turn.y(), 0.8f * turn.y() + 0.6f * turn.x());
    const NoiseValue noise =
        GradientNoise(turned.x() / octave.length_m, turned.y() / octave.length_m, seed++);
    tone += shown * octave.tone * noise.value;
    appearance.slope += shown * contrast * octave.relief *
                        Eigen::Vector2f(turn.x() * noise.dx - turn.y() * noise.dy,
                                        turn.y() * noise.dx + turn.x() * noise.dy);
  }
  tone = contrast * (tone + SpeckTone(position, extent_m, seed + 100));
  appearance.albedo = std::clamp(1.0f + tone, 0.12f, 1.9f) *
                      kDrySand.cwiseProduct(Eigen::Vector3f(1.0f + tint, 1.0f, 1.0f - 1.5f * tint));
  return appearance;
}

Appearance DuneAppearance(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed) {
  const float patch = GradientNoise(position.x() / 14.0, position.y() / 14.0, seed).value +
                      0.5f * GradientNoise(position.x() / 4.0, position.y() / 4.0, seed + 1).value;
  const float grass = std::clamp(3.0f * (patch - 0.05f), 0.0f, 1.0f);
  const float tuft =
      1.0f + 0.5f * Shown(0.8f, extent_m) *
                 GradientNoise(position.x() / 0.8, position.y() / 0.8, seed + 2).value;
  const Eigen::Vector3f green = tuft * Eigen::Vector3f(0.13f, 0.14f, 0.06f);
  return {(1.0f - grass) * 1.1f * kDrySand + grass * green};
}

Appearance SeaAppearance(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed) {
  const float swell =
      Shown(3.0f, extent_m) * GradientNoise(position.x() / 3.0, position.y() / 18.0, seed).value;
  const bool is_surf = position.x() > -190.0 && swell > 0.25f;
  return {is_surf ? Eigen::Vector3f(0.6f, 0.62f, 0.62f)
                  : Eigen::Vector3f((1.0f + 0.25f * swell) * Eigen::Vector3f(0.13f, 0.17f, 0.20f))};
}

float RockTone(const Eigen::Vector3d& position, float extent_m, float contrast,
               std::uint32_t seed) {
  float tone = 0.0f;
  for (const auto& [length_m, depth] :
       {std::array{0.21f, 0.22f}, std::array{0.07f, 0.22f}, std::array{0.026f, 0.24f},
        std::array{0.010f, 0.24f}, std::array{0.004f, 0.22f}}) {
    const float shown = Shown(length_m, extent_m);
    if (shown == 0.0f) break;
    tone += shown * depth *
            GradientNoise3(position.x() / length_m, position.y() / length_m,
                           position.z() / length_m, ++seed);
  }
  return std::clamp(1.0f + contrast * tone, 0.2f, 1.8f);
}

Eigen::Vector3f SkyRadiance(const Eigen::Vector3f& direction, const Eigen::Vector3f& sun,
                            std::uint32_t seed) {
  const float up = std::max(direction.z(), 0.02f);
  const double x = direction.x() / (up + 0.12f), y = direction.y() / (up + 0.12f);
  const float clouds = GradientNoise(0.6 * x, 1.1 * y, seed).value +
                       0.5f * GradientNoise(1.7 * x, 3.1 * y, seed + 1).value +
                       0.25f * GradientNoise(5.0 * x, 8.0 * y, seed + 2).value;
  const float haze = std::exp(-11.0f * up);
  const Eigen::Vector3f blue(0.52f, 0.60f, 0.70f), grey(0.82f, 0.82f, 0.83f),
      white(0.98f, 0.96f, 0.93f);
  const float cover = std::clamp(0.5f + 1.1f * clouds, 0.0f, 1.0f);
  Eigen::Vector3f sky = blue + cover * (grey - blue);
  sky += haze * (white - sky);
  const float glow = std::pow(std::max(0.0f, direction.dot(sun)), 24.0f);
  return sky + 1.6f * glow * Eigen::Vector3f(1.0f, 0.95f, 0.85f);
}

}  // namespace rigmap
