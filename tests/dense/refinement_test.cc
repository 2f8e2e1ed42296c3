#include "dense/internal/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kColumns = 320, kRows = 200;
constexpr double kFocal_px = 400.0;
constexpr double kFarFocal_px = 1e12;  // where windows are narrower than any sigma
constexpr int kFirstColumn = 40;       // further left the right view does not see it

// Grey values as a sum of waves 6 to 25 px long: what each view shows is known at any place.
class Texture {
 public:
  Texture(SeededRandom& random, double contrast_grey) {
    constexpr int kWaves = 40;
    amplitude_ = contrast_grey * std::sqrt(2.0 / kWaves);
    for (int i = 0; i < kWaves; ++i) {
      const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const double per_px = 2.0 * std::numbers::pi / random.Uniform(6.0, 25.0);
      waves_.push_back({per_px * std::cos(direction), per_px * std::sin(direction),
                        random.Uniform(0.0, 2.0 * std::numbers::pi)});
    }
  }
  double At(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::cos(wave.x * x + wave.y * y + wave.phase);
    return 128.0 + amplitude_ * sum;
  }

 private:
  struct Wave {
    double x = 0.0, y = 0.0, phase = 0.0;
  };
  std::vector<Wave> waves_;
  double amplitude_ = 0.0;
};

using DisparityAt = std::function<double(int column, int row)>;

struct Surface {
  const char* name;
  DisparityAt disparity;
};

void PrintTo(const Surface& surface, std::ostream* stream) { *stream << surface.name; }

double Affine(int column, int row) { return 20.0 + 0.03 * column - 0.02 * row; }
double Curved(int column, int row) {
  return 15.0 + 8.0 * std::sin(column / 60.0) * std::cos(row / 50.0) + 0.01 * row;
}
double Step(int column, int row) { return column + 0.3 * row < 190.0 ? 20.3 : 25.3; }

cv::Mat Filled(const std::function<double(int column, int row)>& value) {
  cv::Mat filled(kRows, kColumns, CV_32F);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      filled.at<float>(row, column) = static_cast<float>(value(column, row));
    }
  }
  return filled;
}

// Known in the part that both views see.
cv::Mat KnownWhereSeen(const std::function<double(int column, int row)>& value) {
  cv::Mat disparity = Filled(value);
  disparity.colRange(0, kFirstColumn) = 0.0F;
  return disparity;
}

struct ViewPair {
  cv::Mat left, right;
};

ViewPair Render(const Texture& texture, const DisparityAt& disparity, SeededRandom& random) {
  constexpr double kNoiseGrey = 2.0;
  ViewPair pair;
  Filled([&](int column, int row) {
    return texture.At(column - disparity(column, row), row) + random.Normal(kNoiseGrey);
  }).convertTo(pair.left, CV_8U);
  Filled([&](int column, int row) {
    return texture.At(column, row) + random.Normal(kNoiseGrey);
  }).convertTo(pair.right, CV_8U);
  return pair;
}

// In quarters of a pixel, and a tenth of one too large.
cv::Mat RoundedAndBiased(const DisparityAt& truth) {
  return KnownWhereSeen(
      [&](int column, int row) { return std::round(4.0 * truth(column, row)) / 4.0 + 0.1; });
}

// Found less true disparity of each known pixel, over its sigma if there is one; sorted.
std::vector<double> Errors(const cv::Mat& found, const DisparityAt& truth,
                           const cv::Mat& sigma = {}) {
  std::vector<double> errors;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double found_px = found.at<float>(row, column);
      if (found_px <= 0.0) continue;
      const double unit = sigma.empty() ? 1.0 : sigma.at<float>(row, column);
      errors.push_back((found_px - truth(column, row)) / unit);
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

double Rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

class RefineDisparityOf : public testing::TestWithParam<Surface> {
 protected:
  SeededRandom random_;
  DenseOptions options_;
};

INSTANTIATE_TEST_SUITE_P(Surfaces, RefineDisparityOf,
                         testing::Values(Surface{"Affine", Affine}, Surface{"Curved", Curved}),
                         [](const auto& surface) { return surface.param.name; });

TEST_P(RefineDisparityOf, TakesRoundingAndBiasAway) {
  const ViewPair pair = Render(Texture(random_, 20.0), GetParam().disparity, random_);
  const cv::Mat rough = RoundedAndBiased(GetParam().disparity);
  // Where bends are kept, more of the noise stays as well.
  for (const auto& [focal_px, most] : {std::pair(kFocal_px, 0.6), std::pair(kFarFocal_px, 0.5)}) {
    const RefinedDisparity refined =
        RefineDisparity(pair.left, pair.right, rough, focal_px, options_);
    const auto errors = Errors(refined.disparity, GetParam().disparity);
    // Here and there even white noise is nearly level for nine pixels.
    EXPECT_GT(errors.size(), 0.999 * cv::countNonZero(rough));
    EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.02) << "px";
    EXPECT_LT(Rms(errors), most * Rms(Errors(rough, GetParam().disparity))) << focal_px;
  }
}

TEST_P(RefineDisparityOf, ReducesNoise) {
  const ViewPair pair = Render(Texture(random_, 20.0), GetParam().disparity, random_);
  const cv::Mat noisy = KnownWhereSeen(
      [&](int column, int row) { return GetParam().disparity(column, row) + random_.Normal(0.2); });
  const RefinedDisparity refined =
      RefineDisparity(pair.left, pair.right, noisy, kFocal_px, options_);
  const auto errors = Errors(refined.disparity, GetParam().disparity);
  EXPECT_LT(Rms(errors), 0.06) << "px, of 0.2";
}

// Noise of both views is independent from pixel to pixel here, as least squares suppose.
TEST_P(RefineDisparityOf, KnowsItsSigma) {
  options_.refined_sigma_factor = 1.0;
  options_.least_sigma_px = 1e-3;
  for (const double contrast_grey : {5.0, 10.0, 20.0}) {
    const ViewPair pair = Render(Texture(random_, contrast_grey), GetParam().disparity, random_);
    const RefinedDisparity refined = RefineDisparity(
        pair.left, pair.right, RoundedAndBiased(GetParam().disparity), kFocal_px, options_);
    const double normalised = Rms(Errors(refined.disparity, GetParam().disparity, refined.sigma));
    EXPECT_GT(normalised, 0.5) << contrast_grey;
    EXPECT_LT(normalised, 1.5) << contrast_grey;
  }
}

TEST_P(RefineDisparityOf, WidensItsSigmaAsTheOptionsSay) {
  const ViewPair pair = Render(Texture(random_, 10.0), GetParam().disparity, random_);
  const cv::Mat rough = RoundedAndBiased(GetParam().disparity);
  const auto sigma_with = [&](double factor, double least_px) {
    options_.refined_sigma_factor = factor;
    options_.least_sigma_px = least_px;
    return RefineDisparity(pair.left, pair.right, rough, kFarFocal_px, options_).sigma;
  };
  const cv::Mat plain = sigma_with(1.0, 1e-6), widened = sigma_with(3.0, 0.05);
  const cv::Mat bend = sigma_with(1e-6, 1e-6);  // what smoothing takes off
  for (int row = 0; row < kRows; ++row) {
    for (int column = kFirstColumn; column < kColumns; ++column) {
      const auto square = [&](const cv::Mat& sigma) {
        return std::pow(sigma.at<float>(row, column), 2.0);
      };
      const double expected = square(bend) + 9.0 * (square(plain) - square(bend)) + 0.05 * 0.05;
      ASSERT_NEAR(widened.at<float>(row, column), std::sqrt(expected), 1e-4);
    }
  }
}

TEST_P(RefineDisparityOf, DoesNotMindBrightness) {
  const ViewPair pair = Render(Texture(random_, 12.0), GetParam().disparity, random_);
  const cv::Mat rough = RoundedAndBiased(GetParam().disparity);
  const cv::Mat brighter = pair.right + 30;
  ASSERT_LT(*std::max_element(brighter.begin<uchar>(), brighter.end<uchar>()), 255);
  const RefinedDisparity one = RefineDisparity(pair.left, pair.right, rough, kFocal_px, options_);
  const RefinedDisparity other = RefineDisparity(pair.left, brighter, rough, kFocal_px, options_);
  EXPECT_LT(cv::norm(one.disparity, other.disparity, cv::NORM_INF), 1e-3) << "px";
  EXPECT_LT(cv::norm(one.sigma, other.sigma, cv::NORM_INF), 1e-3) << "px";
}

TEST_P(RefineDisparityOf, KnowsNothingWhereNothingButNoiseIsSeen) {
  cv::Mat left(kRows, kColumns, CV_8UC1), right(kRows, kColumns, CV_8UC1);
  for (cv::Mat* view : {&left, &right}) {
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        view->at<uchar>(row, column) = cv::saturate_cast<uchar>(20.0 + random_.Normal(2.0));
      }
    }
  }
  const cv::Mat rough = RoundedAndBiased(GetParam().disparity);
  const RefinedDisparity dark = RefineDisparity(left, right, rough, kFocal_px, options_);
  // Texture has to stand out by one sigma.
  EXPECT_LT(cv::countNonZero(dark.disparity), 0.16 * cv::countNonZero(rough));
  const cv::Mat flat(kRows, kColumns, CV_8UC1, cv::Scalar(1));
  EXPECT_EQ(cv::countNonZero(RefineDisparity(flat, flat, rough, kFocal_px, options_).disparity), 0);
}

TEST_P(RefineDisparityOf, LeavesTheUnknownUnknown) {
  const ViewPair pair = Render(Texture(random_, 20.0), GetParam().disparity, random_);
  cv::Mat rough = RoundedAndBiased(GetParam().disparity);
  rough(cv::Rect(150, 60, 40, 30)) = 0.0F;
  for (int i = 0; i < 2000; ++i) {
    rough.at<float>(static_cast<int>(random_.Uniform(0.0, kRows)),
                    static_cast<int>(random_.Uniform(0.0, kColumns))) = 0.0F;
  }
  const RefinedDisparity refined =
      RefineDisparity(pair.left, pair.right, rough, kFocal_px, options_);
  const cv::Mat was_known = rough > 0.0F, is_known = refined.disparity > 0.0F;
  EXPECT_EQ(cv::countNonZero(is_known & ~was_known), 0);
  EXPECT_GT(cv::countNonZero(is_known), 0.999 * cv::countNonZero(was_known));
  EXPECT_EQ(cv::countNonZero(refined.disparity < 0.0F), 0);
  const auto errors = Errors(refined.disparity, GetParam().disparity);
  EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.02) << "px";
}

// Least distance from either side of Step.
double FromStepPx(double disparity_px) {
  return std::min(std::abs(disparity_px - 20.3), std::abs(disparity_px - 25.3));
}

TEST(RefineDisparity, PutsNothingBetweenTheSidesOfAStep) {
  SeededRandom random;
  const ViewPair pair = Render(Texture(random, 20.0), Step, random);
  const RefinedDisparity refined =
      RefineDisparity(pair.left, pair.right, RoundedAndBiased(Step), kFocal_px, {});
  for (int row = 0; row < kRows; ++row) {
    for (int column = kFirstColumn; column < kColumns; ++column) {
      ASSERT_LT(FromStepPx(refined.disparity.at<float>(row, column)), 0.7) << column << ", " << row;
    }
  }
  const auto errors = Errors(refined.disparity, Step);
  EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.02) << "px";
}

// A matcher errs differently on either side; a window over both would find the mean of it.
TEST(RefineDisparity, TellsTheSidesOfAStepApart) {
  constexpr int kReachPx = 4;  // of the windows
  SeededRandom random;
  const ViewPair pair = Render(Texture(random, 20.0), Step, random);
  const cv::Mat rough = KnownWhereSeen([](int column, int row) {
    const double truth = Step(column, row);
    return truth < 23.0 ? truth - 0.3 : truth + 0.3;
  });
  cv::Mat refined = RefineDisparity(pair.left, pair.right, rough, kFocal_px, {}).disparity;
  for (int row = 0; row < kRows; ++row) {
    const int last_below = static_cast<int>(std::ceil(190.0 - 0.3 * row)) - 1;
    for (int column = kFirstColumn; column < kColumns; ++column) {
      const bool is_beside = std::abs(column - last_below - 0.5) < kReachPx;
      if (!is_beside) refined.at<float>(row, column) = 0.0F;
    }
  }
  const auto errors = Errors(refined, Step);
  ASSERT_GT(errors.size(), 0.95 * 2 * kReachPx * kRows);
  EXPECT_LT(Rms(errors), 0.1) << "px, of 0.3";
}

// Of a bowl d = c (x2 + y2), pairs that lie (dx, dy) off are higher by c (dx2 + dy2).
TEST(SquareBendOf, IsThatOfABowlAndNothingOnAPlane) {
  constexpr double kCurvature = 0.01;  // px of disparity by px2
  const cv::Mat bowl = KnownWhereSeen([](int column, int row) {
    return 20.0 + kCurvature * (std::pow(column - 200.0, 2.0) + std::pow(row - 60.0, 2.0));
  });
  double sum = 0.0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) sum += std::pow(kCurvature * (dx * dx + dy * dy), 2.0);
  }
  EXPECT_NEAR(SquareBendOf(bowl, 2).at<float>(60, 200), sum / 24.0, 1e-5);  // the middle is no pair
  EXPECT_LT(cv::norm(SquareBendOf(KnownWhereSeen(Affine), 3), cv::NORM_INF), 1e-8);
  EXPECT_LT(cv::norm(SquareBendOf(KnownWhereSeen(Step), 3), cv::NORM_INF), 1e-8);
}

double Ridge(int column, int row) { return 24.0 - 0.25 * std::abs((column + row) % 16 - 8.0); }

// Where the surface bends within a window, both smoothings flatten it.
TEST(RefineDisparity, KnowsWhatSmoothingTakesOffARidge) {
  SeededRandom random;
  const ViewPair pair = Render(Texture(random, 20.0), Ridge, random);
  for (const double focal_px : {kFocal_px, kFarFocal_px}) {
    const RefinedDisparity refined =
        RefineDisparity(pair.left, pair.right, KnownWhereSeen(Ridge), focal_px, {});
    const double normalised = Rms(Errors(refined.disparity, Ridge, refined.sigma));
    EXPECT_GT(normalised, 0.5) << focal_px;
    EXPECT_LT(normalised, 1.5) << focal_px;
  }
}

TEST(RefineDisparity, KeepsBendsWhereDepthIsKnownToLessThanAWindowsWidth) {
  SeededRandom random;
  const ViewPair pair = Render(Texture(random, 20.0), Ridge, random);
  const cv::Mat rough = KnownWhereSeen(Ridge);
  const cv::Mat near = RefineDisparity(pair.left, pair.right, rough, kFocal_px, {}).disparity;
  const cv::Mat far = RefineDisparity(pair.left, pair.right, rough, kFarFocal_px, {}).disparity;
  EXPECT_LT(Rms(Errors(near, Ridge)), 0.8 * Rms(Errors(far, Ridge)));
  const DenseOptions plain{.keep_bends = false};
  const cv::Mat mean = RefineDisparity(pair.left, pair.right, rough, kFocal_px, plain).disparity;
  EXPECT_EQ(cv::norm(mean, far, cv::NORM_INF), 0.0);
}

TEST(SmoothDisparity, KeepsAPlane) {
  SeededRandom random;
  cv::Mat plane = KnownWhereSeen(Affine);
  for (int i = 0; i < 5000; ++i) {
    plane.at<float>(static_cast<int>(random.Uniform(0.0, kRows)),
                    static_cast<int>(random.Uniform(0.0, kColumns))) = 0.0F;
  }
  for (const int radius_px : {0, 1, 3, 6}) {
    EXPECT_LT(cv::norm(SmoothDisparity(plane, radius_px), plane, cv::NORM_INF), 1e-4) << radius_px;
  }
}

TEST(SmoothDisparity, DoesNotMixAcrossAStep) {
  const cv::Mat step = KnownWhereSeen(Step);
  EXPECT_LT(cv::norm(SmoothDisparity(step, 3), step, cv::NORM_INF), 1e-4);
}

TEST(SmoothDisparity, AveragesNoiseAway) {
  SeededRandom random;
  const cv::Mat noisy =
      KnownWhereSeen([&](int column, int row) { return Affine(column, row) + random.Normal(0.1); });
  const double before_px = Rms(Errors(noisy, Affine));
  EXPECT_LT(Rms(Errors(SmoothDisparity(noisy, 3), Affine)), 0.2 * before_px);  // 1/7 but for edges
  EXPECT_EQ(cv::norm(SmoothDisparity(noisy, 0), noisy, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace rigmap
