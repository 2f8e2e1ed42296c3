#include "correspondence/patch_alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kSize = 61;
const Eigen::Vector2i kCentre(30, 30);
using Surface = std::function<double(const Eigen::Vector2d&)>;

using Waves = std::vector<Eigen::Vector3d>;  // number along both axes, 1/px, and phase

// In all directions.
Waves RandomWaves(double shortest_px, double longest_px, SeededRandom& random) {
  Waves waves;
  for (int i = 0; i < 12; ++i) {
    const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const double number = 2.0 * std::numbers::pi / random.Uniform(shortest_px, longest_px);
    waves.emplace_back(number * std::cos(direction), number * std::sin(direction),
                       random.Uniform(0.0, 2.0 * std::numbers::pi));
  }
  return waves;
}

// Grey values of about 90, as a lens shows them that makes a spot of sigma `blur_px` of every
// point. Contrast may grow downwards: such a wave is one of complex number.
Surface Seen(const Waves& waves, double blur_px, double contrast = 10.0, double growth = 0.0) {
  return [=](const Eigen::Vector2d& x) {
    const double variance = blur_px * blur_px;
    double sum = 0.0;
    for (const auto& wave : waves) {
      sum += std::exp(0.5 * variance * (growth * growth - wave.head<2>().squaredNorm())) *
             std::sin(wave.head<2>().dot(x) + wave.z() + variance * growth * wave.y());
    }
    return 90.0 + contrast * std::exp(growth * x.y()) * sum;
  };
}

// A window of 13 px hardly tells longer waves from a plane of brightness, which it leaves free.
Waves UsualWaves(SeededRandom& random) { return RandomWaves(7.0, 18.0, random); }

Surface RandomTexture(SeededRandom& random) { return Seen(UsualWaves(random), 0.0); }

constexpr double kBlur_px = 0.5;  // of a sharp image

struct Image {
  std::vector<std::uint8_t> grey = std::vector<std::uint8_t>(kSize * kSize);
  GreyView View() const { return {grey.data(), kSize, kSize, kSize}; }
};

// `surface` seen through `warp` from the source's centre, with a gain and an offset of brightness.
Image Draw(const Surface& surface, const PatchWarp& warp, double gain = 1.0, double offset = 0.0) {
  const Eigen::Matrix2d source_from_target = warp.linear.inverse();
  Image image;
  for (int i = 0; i < kSize * kSize; ++i) {
    const Eigen::Vector2d x(i % kSize, i / kSize);
    const double grey = surface(source_from_target * (x - warp.position));
    image.grey[i] = static_cast<std::uint8_t>(
        std::clamp(std::lround(gain * grey + offset), std::lround(0.0), std::lround(255.0)));
  }
  return image;
}

PatchWarp AtCentre() { return {.position = kCentre.cast<double>()}; }

PatchWarp Turned(double angle_rad, double scale, const Eigen::Vector2d& shift) {
  PatchWarp warp;
  warp.linear = scale * Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  warp.position = kCentre.cast<double>() + shift;
  return warp;
}

Eigen::Vector2d RandomShift(double reach_px, SeededRandom& random) {
  return {random.Uniform(-reach_px, reach_px), random.Uniform(-reach_px, reach_px)};
}

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(AlignPatch, FindsSubPixelShifts) {
  SeededRandom random;
  constexpr int kTrials = 50;
  double squared_errors = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Surface surface = RandomTexture(random);
    const Image source = Draw(surface, AtCentre());
    const PatchWarp truth = Turned(0.0, 1.0, RandomShift(1.5, random));
    const auto found =
        AlignPatch(source.View(), kCentre, Draw(surface, truth).View(), AtCentre(), {});
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->warp.position - truth.position).norm(), 0.05) << trial;
    EXPECT_GT(found->correlation, 0.99);
    EXPECT_LT(found->sigma_px, 0.05);
    squared_errors += (found->warp.position - truth.position).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squared_errors / kTrials), 0.015);  // px, of rounding
}

// Neighbouring rows of a stereo pair lie between pixels alike: what draws one window draws all.
TEST(AlignPatch, IsNotDrawnTowardsOrAwayFromPixels) {
  SeededRandom random;
  constexpr int kTrials = 200;
  for (const double share : {0.25, 0.5, 0.75}) {
    const PatchWarp truth = Turned(0.0, 1.0, {0.0, share});
    double sum = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Surface surface = Seen(RandomWaves(3.0, 12.0, random), kBlur_px, 6.0);
      const auto found = AlignPatch(Draw(surface, AtCentre()).View(), kCentre,
                                    Draw(surface, truth).View(), AtCentre(), {});
      ASSERT_TRUE(found) << share << ' ' << trial;
      sum += found->warp.position.y() - truth.position.y();
    }
    EXPECT_LT(std::abs(sum / kTrials), 0.004) << share;  // px; cubic convolution: 0.018
  }
}

TEST(AlignPatch, FindsScaleRotationGainAndOffset) {
  SeededRandom random;
  for (int trial = 0; trial < 50; ++trial) {
    const Waves waves = UsualWaves(random);
    const Image source = Draw(Seen(waves, kBlur_px), AtCentre());
    const double angle_rad = (trial % 2 ? 5.0 : -5.0) * kDegree,
                 scale = trial % 4 < 2 ? 1.2 : 1 / 1.2;
    const PatchWarp truth = Turned(angle_rad, scale, RandomShift(1.0, random));
    const Image target = Draw(Seen(waves, kBlur_px / scale), truth, 1.5, 20.0);
    const auto found = AlignPatch(source.View(), kCentre, target.View(), AtCentre(), {});
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->warp.position - truth.position).norm(), 0.03) << trial;
    EXPECT_LT((found->warp.linear - truth.linear).cwiseAbs().maxCoeff(), 0.03) << trial;
    EXPECT_GT(found->correlation, 0.99);
  }
}

// From nearby a view is sharper.
TEST(AlignPatch, ASharperViewIsNotDrawnToTheSideOfMoreTexture) {
  SeededRandom random;
  constexpr double kNearer = 1.5, kContrast = 6.0, kGrowth = 0.15;
  constexpr int kTrials = 200;
  Eigen::Vector2d mean_error = Eigen::Vector2d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    const Waves waves = RandomWaves(4.0, 9.0, random);
    const Image source = Draw(Seen(waves, kBlur_px, kContrast, kGrowth), AtCentre());
    const PatchWarp truth = Turned(0.0, kNearer, RandomShift(1.0, random));
    const Image target = Draw(Seen(waves, kBlur_px / kNearer, kContrast, kGrowth), truth);
    PatchWarp start = AtCentre();
    start.linear *= kNearer;
    const auto found = AlignPatch(source.View(), kCentre, target.View(), start, {});
    ASSERT_TRUE(found) << trial;
    mean_error += (found->warp.position - truth.position) / kTrials;
  }
  EXPECT_LT(mean_error.norm(), 0.01);  // px; 0.034 if the template is taken as it is
}

// Ground seen flatly bends within the window; where nobody knows by how much a low window is drawn
// aside by less.
TEST(AlignPatch, ALowWindowSuffersLessFromABend) {
  SeededRandom random;
  double low_px = 0.0, square_px = 0.0;
  constexpr int kTrials = 40;
  for (int i = 0; i < kTrials; ++i) {
    const Surface surface = Seen(RandomWaves(4.0, 10.0, random), kBlur_px);
    // What grows by a quarter while its depth changes by 1.6 % from row to row.
    constexpr double kBend = 0.004;
    const Image source = Draw(surface, AtCentre());
    const Image target = Draw(
        [&](const Eigen::Vector2d& x) {
          return surface({x.x(), x.y() - kBend * x.y() * x.y()});
        },
        AtCentre());
    const auto shift = [&](int half_height_px) {
      const auto found = AlignPatch(source.View(), kCentre, target.View(), AtCentre(),
                                    {.half_height_px = half_height_px});
      return found ? found->warp.position.y() - kCentre.y() : NAN;
    };
    low_px += shift(3) / kTrials;
    square_px += shift(6) / kTrials;
  }
  EXPECT_GT(square_px, 0.02);
  EXPECT_LT(std::abs(low_px), 0.5 * square_px);
}

TEST(AlignPatch, ThereAndBackIsTheIdentity) {
  SeededRandom random;
  for (int trial = 0; trial < 20; ++trial) {
    const Surface surface = RandomTexture(random);
    const Image a = Draw(surface, AtCentre());
    const Image b = Draw(surface, Turned(0.05, 1.1, RandomShift(0.5, random)));
    const auto there = AlignPatch(a.View(), kCentre, b.View(), AtCentre(), {});
    const auto back = AlignPatch(b.View(), kCentre, a.View(), AtCentre(), {});
    ASSERT_TRUE(there && back);
    // b's centre goes to back.position; from there to b again.
    const Eigen::Vector2d again =
        there->warp.position + there->warp.linear * (back->warp.position - kCentre.cast<double>());
    EXPECT_LT((again - kCentre.cast<double>()).norm(), 0.05) << trial;
  }
}

TEST(AlignPatch, BrightnessDoesNotMatter) {
  SeededRandom random;
  const Surface surface = RandomTexture(random);
  const Image source = Draw(surface, AtCentre());
  const PatchWarp truth = Turned(0.0, 1.0, {0.4, -0.7});
  const auto plain =
      AlignPatch(source.View(), kCentre, Draw(surface, truth).View(), AtCentre(), {});
  const auto dimmed =
      AlignPatch(source.View(), kCentre, Draw(surface, truth, 0.6, 60.0).View(), AtCentre(), {});
  ASSERT_TRUE(plain && dimmed);
  EXPECT_LT((plain->warp.position - dimmed->warp.position).norm(), 0.02);  // px, of rounding
}

// Stray light and vignetting rest in the image, and fall off differently where the other camera
// sees the same ground: with gain and offset alone such windows are drawn aside by 0.1 to 1 px.
TEST(AlignPatch, SlopesOfBrightnessDoNotMatter) {
  SeededRandom random;
  for (int trial = 0; trial < 20; ++trial) {
    const Surface surface = RandomTexture(random);
    const PatchWarp truth = Turned(0.0, 1.0, {0.4, -0.7});
    const Eigen::Vector2d slope = RandomShift(3.0, random);  // grey levels per pixel
    const Surface lit = [&](const Eigen::Vector2d& u) { return surface(u) + slope.dot(u); };
    const auto found = AlignPatch(Draw(surface, AtCentre()).View(), kCentre,
                                  Draw(lit, truth).View(), AtCentre(), {});
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->warp.position - truth.position).norm(), 0.03) << slope.transpose();
    EXPECT_GT(found->correlation, 0.99);
  }
}

TEST(AlignPatch, RefusesFlatPatches) {
  SeededRandom random;
  const Image texture = Draw(RandomTexture(random), AtCentre());
  const Image flat = Draw([](const Eigen::Vector2d&) { return 100.0; }, AtCentre());
  Image noisy = flat;
  for (auto& grey : noisy.grey)
    grey = static_cast<std::uint8_t>(grey + (random.Uniform(0, 1) < 0.5));
  EXPECT_FALSE(AlignPatch(flat.View(), kCentre, flat.View(), AtCentre(), {}));
  EXPECT_FALSE(AlignPatch(noisy.View(), kCentre, noisy.View(), AtCentre(), {}));
  EXPECT_FALSE(AlignPatch(flat.View(), kCentre, texture.View(), AtCentre(), {}));
  EXPECT_FALSE(AlignPatch(texture.View(), kCentre, flat.View(), AtCentre(), {}));
}

TEST(AlignPatch, RefusesOrDoubtsEdges) {
  SeededRandom random;
  for (int trial = 0; trial < 40; ++trial) {
    const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector2d across(std::cos(direction), std::sin(direction));
    const double noise = trial < 20 ? 0.0 : 2.0;  // grey levels
    const Surface edge = [&](const Eigen::Vector2d& x) {
      return 100.0 + 60.0 * std::tanh(across.dot(x) / 2.0) +
             (noise > 0.0 ? random.Normal(noise) : 0.0);
    };
    const Image source = Draw(edge, AtCentre());
    const Image target = Draw(edge, Turned(0.0, 1.0, RandomShift(0.5, random)));
    const auto found = AlignPatch(source.View(), kCentre, target.View(), AtCentre(), {});
    if (found) {
      EXPECT_GT(found->sigma_px, 0.15)
          << "edge across " << across.transpose() << " noise " << noise;
    }
  }
}

TEST(AlignPatch, WrongPatchesCorrelateLittle) {
  SeededRandom random;
  int accepted = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Image source = Draw(RandomTexture(random), AtCentre());
    const Image other = Draw(RandomTexture(random), AtCentre());
    const auto found = AlignPatch(source.View(), kCentre, other.View(), AtCentre(), {});
    accepted += found && found->correlation > 0.8;
  }
  EXPECT_LE(accepted, kTrials / 50);
}

TEST(AlignPatch, SigmaIsHonest) {
  SeededRandom random;
  constexpr int kTrials = 300;
  double squared_errors = 0.0, squared_sigmas = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Surface surface = RandomTexture(random);
    const Surface noisy = [&](const Eigen::Vector2d& x) { return surface(x) + random.Normal(4.0); };
    const PatchWarp truth = Turned(0.0, 1.0, RandomShift(0.5, random));
    const auto found = AlignPatch(Draw(surface, AtCentre()).View(), kCentre,
                                  Draw(noisy, truth).View(), AtCentre(), {});
    ASSERT_TRUE(found);
    squared_errors += (found->warp.position - truth.position).squaredNorm();
    squared_sigmas += found->sigma_px * found->sigma_px;
  }
  // The error has two axes, of which sigma is the worse; bilinear samples halve the noise.
  const double errors_per_sigma = std::sqrt(squared_errors / squared_sigmas);
  EXPECT_GT(errors_per_sigma, 0.7);
  EXPECT_LT(errors_per_sigma, 1.6);
}

TEST(AlignPatch, RefusesWindowsThatLeaveAnImageAndFarMoves) {
  SeededRandom random;
  const Surface surface = RandomTexture(random);
  const Image image = Draw(surface, AtCentre());
  const PatchAlignmentOptions options;
  const int first = options.half_width_px + 1, last = kSize - 2 - options.half_width_px;
  const auto at = [&](const Eigen::Vector2i& centre) {
    return AlignPatch(image.View(), centre, image.View(), {.position = centre.cast<double>()}, {});
  };
  EXPECT_TRUE(at({first, first}));
  EXPECT_TRUE(at({last, last}));
  EXPECT_FALSE(at({first - 1, first}));
  EXPECT_FALSE(at({first, last + 1}));
  EXPECT_FALSE(AlignPatch(image.View(), kCentre, image.View(), {.position = {3.0, 30.0}}, {}));
  EXPECT_FALSE(AlignPatch(image.View(), kCentre, image.View(), {.position = {30.0, -1e300}}, {}));
  const PatchWarp moved = Turned(0.0, 1.0, {1.0, 0.0});
  EXPECT_FALSE(AlignPatch(image.View(), kCentre, Draw(surface, moved).View(), AtCentre(),
                          {.max_shift_px = 0.9}));
}

}  // namespace
}  // namespace rigmap
