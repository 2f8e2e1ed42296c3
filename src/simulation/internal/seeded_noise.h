// Random numbers of a sensor: the same for equal seeds and purposes, with every standard library.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string_view>

namespace rigmap {

class SeededNoise {
 public:
  // Sequences of different purposes have nothing to do with each other.
  SeededNoise(std::uint64_t seed, std::string_view purpose) {
    std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a
    for (const char letter : purpose) {
      hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3u;
    }
    engine_.seed(seed * 0x9E3779B97F4A7C15u + hash);
  }

  // In [low, high).
  double Between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  // The sum of twelve uniform numbers: never beyond six sigma.
  double Normal(double sigma) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += Between(0.0, 1.0);
    return sigma * sum;
  }
  Eigen::Vector3d Normal(const Eigen::Vector3d& sigmas) {
    const double x = Normal(sigmas.x()), y = Normal(sigmas.y());
    return {x, y, Normal(sigmas.z())};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace rigmap
