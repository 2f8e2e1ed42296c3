#include "simulation/camera_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

constexpr int kReduction = 8;  // glare and bloom are smooth: worked out on fewer pixels
constexpr float kGamma = 2.2f;

// Stray light: some wide patches and what streaks from them, in full scales. CV_32F, one value for
// each kReduction x kReduction pixels.
cv::Mat GlareField(const cv::Size& size, const Shot& shot) {
  HashSequence random(shot.glare_seed, 61);
  struct Patch {
    float x, y, half_width, half_height;
  };
  std::array<Patch, 3> patches;
  for (Patch& patch : patches) {
    patch = {static_cast<float>(random.Between(0.15, 0.85)),
             static_cast<float>(random.Between(0.2, 0.8)),
             static_cast<float>(random.Between(0.15, 0.4)),
             static_cast<float>(random.Between(0.15, 0.4))};
  }
  cv::Mat field(size, CV_32F);
  const auto shift = static_cast<float>(shot.glare_column_px / kReduction);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const float x = (static_cast<float>(column) - shift) / static_cast<float>(size.width),
                  y = static_cast<float>(row) / static_cast<float>(size.height);
      float inside = -1e9f;
      for (const Patch& patch : patches) {
        inside = std::max(inside, 1.0f - std::hypot((x - patch.x) / patch.half_width,
                                                    (y - patch.y) / patch.half_height));
      }
      field.at<float>(row, column) =
          inside + 0.45f * GradientNoise(6.0 * x, 6.0 * y, shot.glare_seed).value +
          0.2f * GradientNoise(19.0 * x, 19.0 * y, shot.glare_seed + 1).value;
    }
  }
  // The level above which the wanted share lies.
  const std::vector<float> unsorted(field.begin<float>(), field.end<float>());
  std::vector<float> values = unsorted;
  const auto rank = static_cast<std::ptrdiff_t>(std::clamp(1.0 - shot.glare_area, 0.0, 1.0) *
                                                static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const float level = values[static_cast<std::size_t>(rank)];
  // Just enough there to saturate what sand adds to; brighter inside, a quick fall outside.
  constexpr float kSoftness = 0.15f, kAtLevel = 0.75f, kMost = 1.4f, kVeil = 0.04f;
  for (float& value : values = unsorted) {
    const float inside = (value - level) / kSoftness;
    value = kVeil + kAtLevel * (inside > 0.0f ? 1.0f + inside : std::exp(inside));
    value = std::min(value, kMost);
  }
  return cv::Mat(values, true).reshape(1, size.height);
}

// Light that leaves saturated pixels: a halo, and a streak along their columns. Glare has its own
// halo.
cv::Mat BloomField(const cv::Mat& small, const cv::Mat& glare, const CameraResponse& response) {
  std::array<cv::Mat, 3> colours;
  cv::split(small, colours.data());
  const cv::Mat brightest = cv::max(cv::max(colours[0], colours[1]), colours[2]);
  cv::Mat excess, excess_with_glare, halo, streak, whole;
  cv::max(brightest - 1.0f, 0.0f, excess);
  cv::max(brightest + glare - 1.0f, 0.0f, excess_with_glare);
  cv::GaussianBlur(excess, halo, {}, 0.06 * small.cols);
  cv::reduce(excess_with_glare, streak, 0, cv::REDUCE_SUM);
  cv::repeat(streak * (kReduction * response.smear), small.rows, 1, whole);
  return whole + halo * response.bloom;
}

void AddStrayLight(cv::Mat& light, const CameraResponse& response, const Shot& shot) {
  cv::Mat small, field;
  const cv::Size size((light.cols + kReduction - 1) / kReduction,
                      (light.rows + kReduction - 1) / kReduction);
  cv::resize(light, small, size, 0, 0, cv::INTER_AREA);
  cv::Mat stray =
      shot.glare_area > 0.0 ? GlareField(size, shot) : cv::Mat(cv::Mat::zeros(size, CV_32F));
  stray += BloomField(small, stray, response);
  cv::resize(stray, field, light.size(), 0, 0, cv::INTER_LINEAR);
  for (int row = 0; row < light.rows; ++row) {
    auto* pixels = light.ptr<cv::Vec3f>(row);
    const float* added = field.ptr<float>(row);
    for (int column = 0; column < light.cols; ++column) {
      pixels[column] += cv::Vec3f(added[column], 0.98f * added[column], 0.94f * added[column]);
    }
  }
}

// Full scales in steps of 1 / 4095 -> grey levels.
const std::array<float, 4096>& GammaTable() {
  static const auto table = [] {
    std::array<float, 4096> levels{};
    for (std::size_t i = 0; i < levels.size(); ++i) {
      levels[i] = 255.0f * std::pow(static_cast<float>(i) / 4095.0f, 1.0f / kGamma);
    }
    return levels;
  }();
  return table;
}

// Quantiles of the normal distribution: a hash's ten bits pick one.
const std::array<float, 1024>& NormalTable() {
  static const auto table = [] {
    std::array<float, 1024> quantiles{};
    for (std::size_t i = 0; i < quantiles.size(); ++i) {
      // By Newton's method on the distribution function.
      const double wanted = (static_cast<double>(i) + 0.5) / 1024.0;
      double x = 0.0;
      for (int k = 0; k < 60; ++k) {
        const double density = std::max(std::exp(-0.5 * x * x) / 2.5066282746, 1e-4);
        x -= std::clamp((0.5 * std::erfc(-x / std::sqrt(2.0)) - wanted) / density, -0.5, 0.5);
      }
      quantiles[i] = static_cast<float>(x);
    }
    return quantiles;
  }();
  return table;
}

}  // namespace

cv::Mat TakePicture(cv::Mat radiance, const CameraResponse& response, const Shot& shot) {
  if (response.blur_px > 0.0) {
    cv::GaussianBlur(radiance, radiance, {5, 5}, response.blur_px, response.blur_px,
                     cv::BORDER_REPLICATE);
  }
  const auto& curve = GammaTable();
  const auto& normal = NormalTable();
  const int width = radiance.cols, height = radiance.rows;
  const float to_corner2 = 0.25f * static_cast<float>(width * width + height * height);
  const auto exposure = static_cast<float>(response.exposure * shot.exposure_gain);
  for (int row = 0; row < height; ++row) {
    auto* pixels = radiance.ptr<cv::Vec3f>(row);
    const float y = static_cast<float>(row) - 0.5f * static_cast<float>(height);
    for (int column = 0; column < width; ++column) {
      const float x = static_cast<float>(column) - 0.5f * static_cast<float>(width);
      const float falloff =
          1.0f - static_cast<float>(response.vignetting) * (x * x + y * y) / to_corner2;
      pixels[column] *= exposure * falloff;
    }
  }
  AddStrayLight(radiance, response, shot);
  cv::Mat picture(height, width, CV_8UC3);
  const auto read2 = static_cast<float>(response.read_noise * response.read_noise),
             shot2 = static_cast<float>(response.shot_noise);
  for (int row = 0; row < height; ++row) {
    const auto* light = radiance.ptr<cv::Vec3f>(row);
    auto* pixels = picture.ptr<cv::Vec3b>(row);
    for (int column = 0; column < width; ++column) {
      std::uint32_t hash = HashOf(static_cast<std::uint32_t>(column),
                                  static_cast<std::uint32_t>(row), shot.noise_seed);
      for (int colour = 0; colour < 3; ++colour, hash >>= 10) {
        const float share = std::clamp(light[column][colour], 0.0f, 1.0f);
        const float level = curve[static_cast<std::size_t>(4095.0f * share + 0.5f)];
        const float noisy = level + std::sqrt(read2 + shot2 * level) * normal[hash & 1023u] *
                                        (share < 1.0f ? 1.0f : 0.0f);
        pixels[column][2 - colour] =
            static_cast<std::uint8_t>(std::clamp(noisy + 0.5f, 0.0f, 255.0f));
      }
    }
  }
  return picture;
}

double SaturatedShare(const cv::Mat& picture) {
  int count = 0;
  for (int row = 0; row < picture.rows; ++row) {
    const auto* pixels = picture.ptr<cv::Vec3b>(row);
    count += static_cast<int>(std::count(pixels, pixels + picture.cols, cv::Vec3b::all(255)));
  }
  return static_cast<double>(count) / static_cast<double>(picture.total());
}

}  // namespace rigmap
