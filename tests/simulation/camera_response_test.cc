#include "simulation/camera_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace rigmap {
namespace {

constexpr int kWidth = 320, kHeight = 240;

cv::Mat Uniform(double radiance) { return {kHeight, kWidth, CV_32FC3, cv::Scalar::all(radiance)}; }

// Without what depends on place.
CameraResponse Plain() { return {.exposure = 1.0, .vignetting = 0.0, .bloom = 0.0, .smear = 0.0}; }
CameraResponse Noiseless(CameraResponse response) {
  response.read_noise = response.shot_noise = 0.0;
  return response;
}

double LevelOf(double light) { return 255.0 * std::pow(light, 1.0 / 2.2); }

cv::Scalar MeanOf(const cv::Mat& picture, cv::Scalar* sigma = nullptr) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture, mean, deviation);
  if (sigma) *sigma = deviation;
  return mean;
}

// Share of pixels in which exactly one of two pictures is white.
double Disagreement(const cv::Mat& a, const cv::Mat& b) {
  int differing = 0;
  const auto is_white = [](const cv::Vec3b& pixel) { return pixel == cv::Vec3b::all(255); };
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column) {
      differing += is_white(a.at<cv::Vec3b>(row, column)) != is_white(b.at<cv::Vec3b>(row, column));
    }
  }
  return differing / static_cast<double>(a.total());
}

TEST(CameraResponse, LevelsFollowTheGammaCurve) {
  for (const double light : {0.01, 0.05, 0.2, 0.5, 0.9}) {
    const cv::Mat picture = TakePicture(Uniform(light), Noiseless(Plain()), {});
    ASSERT_EQ(picture.type(), CV_8UC3);
    EXPECT_NEAR(MeanOf(picture)[0], LevelOf(light), 0.5 + 0.1 / light / 10.0);
  }
}

TEST(CameraResponse, RedComesLastAsOpenCvStoresIt) {
  const cv::Mat red(kHeight, kWidth, CV_32FC3, cv::Scalar(0.8, 0.4, 0.1));
  const cv::Scalar mean = MeanOf(TakePicture(red.clone(), Plain(), {}));
  EXPECT_NEAR(mean[2], LevelOf(0.8), 1.0);
  EXPECT_NEAR(mean[1], LevelOf(0.4), 1.0);
  EXPECT_NEAR(mean[0], LevelOf(0.1), 1.0);
}

TEST(CameraResponse, NoiseIsAsStated) {
  const CameraResponse response = Plain();
  for (const double light : {0.05, 0.2, 0.5}) {
    cv::Scalar sigma;
    const cv::Scalar mean = MeanOf(TakePicture(Uniform(light), response, {}), &sigma);
    const double rounding = 1.0 / 12.0;  // variance of a whole number of grey levels
    const double expected = std::sqrt(response.read_noise * response.read_noise +
                                      response.shot_noise * mean[0] + rounding);
    for (int colour = 0; colour < 3; ++colour) {
      EXPECT_NEAR(sigma[colour], expected, 0.03 * expected);
      EXPECT_NEAR(mean[colour], LevelOf(light), 0.1);
    }
  }
}

TEST(CameraResponse, NoiseOfNeighboursColoursAndPicturesIsIndependent) {
  cv::Mat a, b;
  TakePicture(Uniform(0.3), Plain(), {.noise_seed = 1}).convertTo(a, CV_32FC3);
  TakePicture(Uniform(0.3), Plain(), {.noise_seed = 2}).convertTo(b, CV_32FC3);
  const auto correlation = [](const cv::Mat& x, const cv::Mat& y) {
    cv::Scalar mean_x, mean_y, sigma_x, sigma_y;
    cv::meanStdDev(x, mean_x, sigma_x);
    cv::meanStdDev(y, mean_y, sigma_y);
    return (x.dot(y) / static_cast<double>(x.total()) - mean_x[0] * mean_y[0]) /
           (sigma_x[0] * sigma_y[0]);
  };
  std::vector<cv::Mat> colours_a, colours_b;
  cv::split(a, colours_a);
  cv::split(b, colours_b);
  constexpr double kFiveSigma = 0.02;  // of 76 800 pixels
  EXPECT_NEAR(correlation(colours_a[0], colours_b[0]), 0.0, kFiveSigma);
  EXPECT_NEAR(correlation(colours_a[0], colours_a[1]), 0.0, kFiveSigma);
  EXPECT_NEAR(correlation(colours_a[1], colours_a[2]), 0.0, kFiveSigma);
  const cv::Mat& grey = colours_a[1];
  EXPECT_NEAR(correlation(grey.colRange(1, kWidth), grey.colRange(0, kWidth - 1)), 0.0, kFiveSigma);
  EXPECT_NEAR(correlation(grey.rowRange(1, kHeight), grey.rowRange(0, kHeight - 1)), 0.0,
              kFiveSigma);
}

TEST(CameraResponse, EqualShotsGiveEqualBytes) {
  const Shot shot{.glare_area = 0.2, .glare_seed = 4, .noise_seed = 5};
  const cv::Mat a = TakePicture(Uniform(0.4), {}, shot), b = TakePicture(Uniform(0.4), {}, shot);
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

TEST(CameraResponse, MeanRisesWithTheExposure) {
  double last = 0.0;
  for (const double gain : {0.4, 0.625, 0.8, 1.0, 1.25, 1.6, 2.0}) {
    const double mean = MeanOf(TakePicture(Uniform(0.35), {}, {.exposure_gain = gain}))[1];
    EXPECT_GT(mean, last + 5.0);
    last = mean;
  }
}

TEST(CameraResponse, CornersLoseTheirShareOfLight) {
  CameraResponse response = Noiseless(Plain());
  response.vignetting = 0.22;
  const cv::Mat picture = TakePicture(Uniform(0.5), response, {});
  const auto at = [&](int row, int column) {
    return static_cast<double>(picture.at<cv::Vec3b>(row, column)[1]);
  };
  EXPECT_NEAR(at(kHeight / 2, kWidth / 2), LevelOf(0.5), 1.0);
  for (const int row : {0, kHeight - 1}) {
    for (const int column : {0, kWidth - 1}) {
      EXPECT_NEAR(at(row, column), LevelOf(0.5 * 0.78), 1.5);
    }
  }
  for (int column = kWidth / 2 + 1; column < kWidth; ++column) {
    EXPECT_LE(at(kHeight / 2, column), at(kHeight / 2, column - 1));
  }
}

TEST(CameraResponse, BlackStaysNearZero) {
  const cv::Mat picture = TakePicture(Uniform(0.0), {}, {});
  double most = 0.0;
  cv::minMaxLoc(picture.reshape(1), nullptr, &most);
  EXPECT_LT(MeanOf(picture)[0], 1.0);
  EXPECT_LE(most, 5.0);
  EXPECT_EQ(SaturatedShare(picture), 0.0);
}

TEST(CameraResponse, SaturatedShareCountsWhiteOnly) {
  cv::Mat half = Uniform(0.2);
  half.colRange(0, kWidth / 4).setTo(cv::Scalar::all(3.0));
  half.colRange(kWidth / 4, kWidth / 2).setTo(cv::Scalar(3.0, 0.2, 0.2));
  EXPECT_NEAR(SaturatedShare(TakePicture(half, Plain(), {})), 0.25, 1e-9);
}

TEST(CameraResponse, GlareSaturatesItsShare) {
  for (const double area : {0.1, 0.3, 0.5, 0.8}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      for (const double scene : {0.05, 0.35}) {
        const Shot shot{.glare_area = area, .glare_seed = seed};
        EXPECT_NEAR(SaturatedShare(TakePicture(Uniform(scene), {}, shot)), area, 0.05)
            << "seed " << seed << ", radiance " << scene;
      }
    }
  }
  EXPECT_EQ(SaturatedShare(TakePicture(Uniform(0.35), {}, {})), 0.0);
}

TEST(CameraResponse, GlareIsTheSameInBothEyesWhateverTheySee) {
  cv::Mat left = Uniform(0.3), right = Uniform(0.3);
  left.colRange(0, kWidth / 2).setTo(cv::Scalar::all(0.35));
  right.rowRange(0, kHeight / 2).setTo(cv::Scalar::all(0.35));
  const auto take = [](const cv::Mat& scene, std::uint32_t seed, std::uint32_t noise) {
    return TakePicture(scene.clone(), {},
                       {.glare_area = 0.3, .glare_seed = seed, .noise_seed = noise});
  };
  EXPECT_LT(Disagreement(take(left, 7, 1), take(right, 7, 2)), 0.03);
  EXPECT_GT(Disagreement(take(left, 7, 1), take(left, 8, 1)), 0.1);
}

TEST(CameraResponse, GlareMovesAsideWithItsColumn) {
  const auto take = [](double column_px) {
    return TakePicture(Uniform(0.05), Noiseless({}),
                       {.glare_area = 0.3, .glare_seed = 7, .glare_column_px = column_px});
  };
  const cv::Mat here = take(0.0), moved = take(16.0);
  EXPECT_LT(Disagreement(here.colRange(0, kWidth - 16), moved.colRange(16, kWidth)), 0.02);
  EXPECT_GT(Disagreement(here, moved), 0.04);
}

TEST(CameraResponse, StreaksRunAlongSaturatedColumnsOnly) {
  CameraResponse response = Noiseless(Plain());
  response.smear = 0.0006;
  cv::Mat scene = Uniform(0.1);
  scene(cv::Rect(160, 120, 24, 40)).setTo(cv::Scalar::all(4.0));
  const cv::Mat without = TakePicture(Uniform(0.1), response, {}),
                with = TakePicture(scene, response, {});
  for (const int row : {4, 60, 230}) {
    for (int column = 0; column < kWidth; ++column) {
      const int added = with.at<cv::Vec3b>(row, column)[1] - without.at<cv::Vec3b>(row, column)[1];
      if (column >= 164 && column < 180) {
        EXPECT_GT(added, 3) << column;
      } else if (column < 152 || column >= 192) {
        EXPECT_EQ(added, 0) << column;
      }
    }
  }
}

TEST(CameraResponse, HaloFadesAroundSaturation) {
  CameraResponse response = Noiseless(Plain());
  response.bloom = 0.25;
  cv::Mat scene = Uniform(0.1);
  scene(cv::Rect(152, 112, 16, 16)).setTo(cv::Scalar::all(6.0));
  const cv::Mat picture = TakePicture(scene, response, {});
  const auto level = [&](int row, int column) {
    return static_cast<int>(picture.at<cv::Vec3b>(row, column)[1]);
  };
  const int open = static_cast<int>(std::lround(LevelOf(0.1)));
  EXPECT_GT(level(120, 180), open + 3);
  EXPECT_GT(level(145, 160), open + 3);
  EXPECT_NEAR(level(120, 10), open, 1);
  for (int column = 176; column < kWidth; ++column) {
    EXPECT_LE(level(120, column), level(120, column - 1));
  }
}

}  // namespace
}  // namespace rigmap
