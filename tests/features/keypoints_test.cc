#include "features/keypoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

struct Blob {
  Eigen::Vector2d centre;
  double sigma_px = 0.0;
};

// One blob in the middle third of every cell of 80 px.
std::vector<Blob> ScatterBlobs(const cv::Size& size, double smallest_px, SeededRandom& random) {
  std::vector<Blob> blobs;
  for (int y = 0; y + 80 <= size.height; y += 80) {
    for (int x = 0; x + 80 <= size.width; x += 80) {
      const double dx = random.Uniform(30.0, 50.0), dy = random.Uniform(30.0, 50.0);
      blobs.push_back({{x + dx, y + dy}, random.Uniform(smallest_px, 6.0)});
    }
  }
  return blobs;
}

cv::Mat Draw(const cv::Size& size, const std::vector<Blob>& blobs) {
  cv::Mat_<float> image(size, 60.0F);
  for (const Blob& blob : blobs) {
    const int reach = static_cast<int>(5.0 * blob.sigma_px);
    const int x0 = static_cast<int>(blob.centre.x()), y0 = static_cast<int>(blob.centre.y());
    for (int y = std::max(0, y0 - reach); y <= std::min(size.height - 1, y0 + reach); ++y) {
      for (int x = std::max(0, x0 - reach); x <= std::min(size.width - 1, x0 + reach); ++x) {
        const double square = (Eigen::Vector2d(x, y) - blob.centre).squaredNorm();
        image(y, x) +=
            static_cast<float>(120.0 * std::exp(-0.5 * square / (blob.sigma_px * blob.sigma_px)));
      }
    }
  }
  cv::Mat grey;
  image.convertTo(grey, CV_8UC1);
  return grey;
}

cv::Mat Noise(const cv::Size& size, double deviation, int seed) {
  cv::Mat noise(size, CV_32FC1), grey;
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(noise, noise, cv::Size(), 2.0);
  noise.convertTo(grey, CV_8UC1, 7.0 * deviation, 110.0);
  return grey;
}

cv::Mat Everything(const cv::Size& size) { return cv::Mat(size, CV_8UC1, cv::Scalar(255)); }

// From each blob to its keypoint; nothing where there is none within a pixel.
std::vector<std::optional<Eigen::Vector2d>> Errors(const std::vector<Blob>& blobs,
                                                   const Keypoints& found) {
  std::vector<std::optional<Eigen::Vector2d>> errors;
  for (const Blob& blob : blobs) {
    auto& error = errors.emplace_back();
    for (const auto& pixel : found.pixels) {
      if ((pixel - blob.centre).norm() < (error ? error->norm() : 1.0)) error = pixel - blob.centre;
    }
  }
  return errors;
}

// SIFT misses a blob in ten whose scale lies just between two of its layers, and places those near
// the step to the next octave worse than the others.
void ExpectBlobsToSubPixel(const cv::Size& size, SeededRandom& random) {
  const std::vector<Blob> blobs = ScatterBlobs(size, 2.0, random);
  std::vector<double> distances_px;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  for (const auto& error :
       Errors(blobs, DetectKeypoints(Draw(size, blobs), Everything(size), {}))) {
    if (!error) continue;
    distances_px.push_back(error->norm());
    mean_px += *error;
  }
  std::sort(distances_px.begin(), distances_px.end());
  const std::size_t count = distances_px.size();
  ASSERT_GT(count, 0.85 * blobs.size());
  EXPECT_LT((mean_px / static_cast<double>(count)).norm(), 0.01);
  EXPECT_LT(distances_px[count / 2], 0.05);
  EXPECT_LT(distances_px[count * 9 / 10], 0.1);
  EXPECT_LT(distances_px.back(), 0.2);
}

TEST(DetectKeypoints, FindsBlobsToSubPixelAtFullResolution) {
  SeededRandom random;
  const cv::Size size(800, 640);
  ASSERT_EQ(SearchReduction(size, {}), 1);
  ExpectBlobsToSubPixel(size, random);
}

TEST(DetectKeypoints, FindsBlobsToSubPixelAtHalfResolution) {
  SeededRandom random;
  const cv::Size size(1024, 768);
  ASSERT_EQ(SearchReduction(size, {}), 2);
  ExpectBlobsToSubPixel(size, random);
}

TEST(DetectKeypoints, FindsBlobsInHalvedImagesOfOddSize) {
  SeededRandom random;
  ExpectBlobsToSubPixel({1023, 767}, random);
}

TEST(DetectKeypoints, SizeGrowsWithTheBlob) {
  const cv::Size size(400, 240);
  const std::vector<Blob> blobs{{{80.0, 120.0}, 2.5}, {{300.0, 120.0}, 5.0}};
  const Keypoints found = DetectKeypoints(Draw(size, blobs), Everything(size), {});
  const auto size_at = [&](const Blob& blob) {
    for (std::size_t i = 0; i < found.pixels.size(); ++i) {
      if ((found.pixels[i] - blob.centre).norm() < 0.2) return found.sizes[i];
    }
    return 0.0F;
  };
  ASSERT_GT(size_at(blobs[0]), 0.0F);
  EXPECT_NEAR(size_at(blobs[1]) / size_at(blobs[0]), 2.0, 0.3);
}

TEST(DetectKeypoints, SpreadsThemOverTheImage) {
  const cv::Size size(640, 480);
  cv::Mat grey = Noise(size, 30.0, 1);
  const cv::Rect right(320, 0, 320, 480);
  Noise(right.size(), 10.0, 2).copyTo(grey(right));
  FeatureOptions options;
  options.max_keypoints = 200;
  const Keypoints found = DetectKeypoints(grey, Everything(size), options);
  ASSERT_EQ(found.pixels.size(), 200u);
  const auto weak = std::count_if(found.pixels.begin(), found.pixels.end(),
                                  [](const auto& pixel) { return pixel.x() > 320.0; });
  EXPECT_GE(weak, 70);
  EXPECT_LE(weak, 130);
}

TEST(DetectKeypoints, MaskedPixelsGiveNone) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(1024, 768)}) {
    const cv::Mat grey = Noise(size, 30.0, 3);
    // Stripes of odd widths, so that half pixels straddle the edges.
    cv::Mat mask = Everything(size);
    for (int x = 0; x < size.width; x += 37) {
      mask.colRange(x, std::min(x + 17, size.width)).setTo(0);
    }
    const Keypoints found = DetectKeypoints(grey, mask, {});
    EXPECT_GT(found.pixels.size(), 300u);
    for (const auto& pixel : found.pixels) {
      EXPECT_EQ(mask.at<std::uint8_t>(cvRound(pixel.y()), cvRound(pixel.x())), 255)
          << pixel.transpose();
    }
    EXPECT_TRUE(DetectKeypoints(grey, cv::Mat::zeros(size, CV_8UC1), {}).pixels.empty());
  }
}

TEST(DetectKeypoints, NoTwoShareAPosition) {
  const cv::Size size(640, 480);
  const Keypoints found = DetectKeypoints(Noise(size, 30.0, 4), Everything(size), {});
  auto pixels = found.pixels;
  const auto less = [](const auto& a, const auto& b) {
    return std::tuple(a.x(), a.y()) < std::tuple(b.x(), b.y());
  };
  std::sort(pixels.begin(), pixels.end(), less);
  EXPECT_EQ(std::adjacent_find(pixels.begin(), pixels.end()), pixels.end());
  EXPECT_EQ(found.sizes.size(), pixels.size());
  EXPECT_EQ(found.found.size(), pixels.size());
  EXPECT_LE(pixels.size(), 1500u);
}

TEST(DetectKeypoints, EqualImagesGiveEqualKeypoints) {
  const cv::Size size(640, 480);
  const cv::Mat grey = Noise(size, 30.0, 5);
  const Keypoints first = DetectKeypoints(grey, Everything(size), {});
  const Keypoints second = DetectKeypoints(grey.clone(), Everything(size), {});
  EXPECT_EQ(first.pixels, second.pixels);
  EXPECT_EQ(first.sizes, second.sizes);
  EXPECT_EQ(Describe(first, {0, 5, 9}), Describe(second, {0, 5, 9}));
}

TEST(Describe, GivesEachOfTheChosenWhatItHasAmongAll) {
  const cv::Size size(640, 480);
  const Keypoints keypoints = DetectKeypoints(Noise(size, 30.0, 6), Everything(size), {});
  std::vector<std::size_t> all(keypoints.pixels.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<Descriptor> of_all = Describe(keypoints, all);
  ASSERT_GT(of_all.size(), 300u);
  std::vector<std::size_t> every_third;
  std::vector<Descriptor> of_every_third;
  for (std::size_t i = 0; i < all.size(); i += 3) {
    every_third.push_back(i);
    of_every_third.push_back(of_all[i]);
  }
  EXPECT_EQ(Describe(keypoints, every_third), of_every_third);
  EXPECT_NE(of_all[299], of_all[7]);
  EXPECT_TRUE(Describe(keypoints, {}).empty());
}

TEST(DetectKeypoints, FindsNothingOnFlatGrey) {
  const cv::Size size(640, 480);
  const cv::Mat flat(size, CV_8UC1, cv::Scalar(120));
  EXPECT_TRUE(DetectKeypoints(flat, Everything(size), {}).pixels.empty());
}

TEST(SearchReduction, HalvesAboveTheLimit) {
  FeatureOptions options;
  options.half_resolution_above_mpx = 0.01;
  EXPECT_EQ(SearchReduction({100, 100}, options), 1);
  EXPECT_EQ(SearchReduction({101, 100}, options), 2);
}

}  // namespace
}  // namespace rigmap
