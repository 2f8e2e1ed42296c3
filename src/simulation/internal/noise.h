// Noise that is a pure function of place and seed: the same everywhere, on any number of threads.
#pragma once

#include <cstdint>

namespace rigmap {

// A well-mixed 32-bit number for three integers (after the finaliser of MurmurHash3).
inline std::uint32_t HashOf(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint32_t h = a * 0x9E3779B1u ^ (b * 0x85EBCA77u + 0x7F4A7C15u) ^ (c * 0xC2B2AE3Du);
  h ^= h >> 16;
  h *= 0x85EBCA6Bu;
  h ^= h >> 13;
  h *= 0xC2B2AE35u;
  h ^= h >> 16;
  return h;
}

// Upper 24 bits of a hash as a number in [0, 1).
inline float UnitOf(std::uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24f; }

// The largest whole number not above x, for |x| < 2^31; std::floor is a call on plain x86-64.
inline std::int32_t FloorOf(double x) {
  const auto towards_zero = static_cast<std::int32_t>(x);
  return towards_zero - (x < static_cast<double>(towards_zero) ? 1 : 0);
}

// A sequence of hashes, for placing things.
class HashSequence {
 public:
  HashSequence(std::uint64_t seed, std::uint32_t purpose)
      : low_(static_cast<std::uint32_t>(seed)),
        high_(static_cast<std::uint32_t>(seed >> 32) ^ (purpose * 0x632BE5ABu)) {}

  std::uint32_t Next() { return HashOf(low_, high_, count_++); }
  double Unit() { return Next() * 0x1p-32; }
  double Between(double low, double high) { return low + (high - low) * Unit(); }

 private:
  std::uint32_t low_, high_, count_ = 0;
};

struct NoiseValue {
  float value = 0.0f;          // within -1 and 1, mean 0, about 0.3 rms
  float dx = 0.0f, dy = 0.0f;  // its derivatives
};

// Gradient noise on the unit lattice with quintic fading (Perlin 2002), smooth to the second
// derivative.
NoiseValue GradientNoise(double x, double y, std::uint32_t seed);

// The same in space, value only; for boulders.
float GradientNoise3(double x, double y, double z, std::uint32_t seed);

}  // namespace rigmap
