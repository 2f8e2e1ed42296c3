#include "simulation/internal/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kSamples = 100000;
constexpr double kReach = 1000.0;  // lattice cells

TEST(Noise, FloorIsThatOfTheLibrary) {
  SeededRandom random;
  for (int i = 0; i < kSamples; ++i) {
    const double x = random.Uniform(-kReach, kReach);
    ASSERT_EQ(FloorOf(x), std::floor(x)) << x;
    ASSERT_EQ(FloorOf(std::round(x)), std::round(x)) << x;
  }
}

TEST(Noise, SequencesRepeatAndPurposesDiffer) {
  HashSequence a(7, 1), same(7, 1), other_purpose(7, 2), other_seed(8, 1),
      high_seed(7 + (1ull << 32), 1);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t number = a.Next();
    ASSERT_EQ(number, same.Next());
    equal += number == other_purpose.Next();
    equal += number == other_seed.Next();
    equal += number == high_seed.Next();
  }
  EXPECT_EQ(equal, 0);
}

TEST(Noise, UnitsAreEvenlySpread) {
  HashSequence random(3, 4);
  std::array<int, 10> counts{};
  for (int i = 0; i < kSamples; ++i) {
    const double unit = random.Unit();
    ASSERT_GE(unit, 0.0);
    ASSERT_LT(unit, 1.0);
    ++counts[static_cast<std::size_t>(10.0 * unit)];
    ASSERT_LT(UnitOf(random.Next()), 1.0f);
  }
  // Five sigmas of a count.
  for (const int count : counts)
    EXPECT_NEAR(count, kSamples / 10, 5.0 * std::sqrt(0.09 * kSamples));
}

TEST(Noise, StaysWithinOneAndHasNoMean) {
  SeededRandom random;
  double sum = 0.0, squares = 0.0, sum3 = 0.0, squares3 = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d position = random.Vector(kReach);
    const float flat = GradientNoise(position.x(), position.y(), 5).value,
                solid = GradientNoise3(position.x(), position.y(), position.z(), 5);
    ASSERT_LE(std::abs(flat), 1.0f);
    ASSERT_LE(std::abs(solid), 1.05f);
    sum += flat;
    squares += flat * flat;
    sum3 += solid;
    squares3 += solid * solid;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.01);
  EXPECT_NEAR(sum3 / kSamples, 0.0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.3, 0.06);
  EXPECT_NEAR(std::sqrt(squares3 / kSamples), 0.3, 0.06);
}

TEST(Noise, SeedsHaveNothingInCommon) {
  SeededRandom random;
  double product = 0.0, product3 = 0.0, variance = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d x = random.Vector(kReach);
    const float value = GradientNoise(x.x(), x.y(), 5).value;
    product += value * GradientNoise(x.x(), x.y(), 6).value;
    product3 += GradientNoise3(x.x(), x.y(), x.z(), 5) * GradientNoise3(x.x(), x.y(), x.z(), 6);
    variance += value * value;
  }
  EXPECT_NEAR(product / variance, 0.0, 0.03);
  EXPECT_NEAR(product3 / variance, 0.0, 0.03);
}

TEST(Noise, DerivativesAreThoseOfTheValue) {
  SeededRandom random;
  constexpr double kStep = 0.004;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.Uniform(-50, 50), y = random.Uniform(-50, 50);
    const auto at = [&](double dx, double dy) {
      return static_cast<double>(GradientNoise(x + dx, y + dy, 9).value);
    };
    const NoiseValue noise = GradientNoise(x, y, 9);
    ASSERT_NEAR(noise.dx, (at(kStep, 0.0) - at(-kStep, 0.0)) / (2.0 * kStep), 1e-3);
    ASSERT_NEAR(noise.dy, (at(0.0, kStep) - at(0.0, -kStep)) / (2.0 * kStep), 1e-3);
  }
}

TEST(Noise, IsSmoothAcrossTheLattice) {
  SeededRandom random;
  constexpr double kGap = 1e-7;
  for (int i = 0; i < 5000; ++i) {
    const double line = std::round(random.Uniform(-50, 50)), y = random.Uniform(-50, 50),
                 z = random.Uniform(-50, 50);
    const NoiseValue west = GradientNoise(line - kGap, y, 3), east = GradientNoise(line, y, 3),
                     south = GradientNoise(y, line - kGap, 3), north = GradientNoise(y, line, 3);
    for (const auto& [a, b] : {std::pair{west, east}, std::pair{south, north}}) {
      ASSERT_NEAR(a.value, b.value, 1e-5);
      ASSERT_NEAR(a.dx, b.dx, 1e-4);
      ASSERT_NEAR(a.dy, b.dy, 1e-4);
    }
    ASSERT_NEAR(GradientNoise3(line - kGap, y, z, 3), GradientNoise3(line, y, z, 3), 1e-5);
    ASSERT_NEAR(GradientNoise3(y, line - kGap, z, 3), GradientNoise3(y, line, z, 3), 1e-5);
    ASSERT_NEAR(GradientNoise3(y, z, line - kGap, 3), GradientNoise3(y, z, line, 3), 1e-5);
    ASSERT_EQ(GradientNoise(line, std::round(y), 3).value, 0.0f);
  }
}

}  // namespace
}  // namespace rigmap
