#include "imaging/depth_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/artefact.h"
#include "core/error.h"
#include "geometry/serialize.h"
#include "imaging/internal/packed_image.h"

namespace rigmap {
namespace {

constexpr double kMostStoredSteps = 64.0;    // per pixel of disparity
constexpr double kStoredSigmaSteps = 128.0;  // per pixel of its sigma

struct StoredDepth {
  StampNs stamp_ns = 0;
  Camera camera;
  Rigid3 left_from_rectified;
  double baseline_m = 0.0, steps_per_px = 0.0;
  std::vector<std::uint8_t> disparity, sigma, smoothed, colour;  // packed

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, camera, left_from_rectified, baseline_m, steps_per_px, disparity, sigma,
            smoothed, colour);
  }
};

// So many that the largest disparity fits into 16 bits.
double StepsPerPixel(const cv::Mat& disparity) {
  double largest_px = 0.0;
  cv::minMaxLoc(disparity, nullptr, &largest_px);
  double steps = kMostStoredSteps;
  while (steps * largest_px >= 65535.0) steps *= 0.5;
  return steps;
}

}  // namespace

std::optional<double> DisparityBiasPx(const DepthMap& map,
                                      std::span<const Eigen::Vector3d> x_in_left) {
  const Rigid3 rectified_from_left = map.left_from_rectified.Inverse();
  std::vector<double> differences;
  for (const Eigen::Vector3d& x : x_in_left) {
    const Eigen::Vector3d x_in_rectified = rectified_from_left * x;
    const std::optional<Eigen::Vector2d> pixel = Project(map.camera, x_in_rectified);
    if (!pixel || !map.camera.Contains(*pixel)) continue;
    const double found = map.disparity.at<float>(static_cast<int>(std::lround(pixel->y())),
                                                 static_cast<int>(std::lround(pixel->x())));
    const double expected = map.camera.fx * map.baseline_m / x_in_rectified.z();
    if (found > 0.0 && std::abs(found - expected) <= kMaxBiasPx) {
      differences.push_back(found - expected);
    }
  }
  if (static_cast<int>(differences.size()) < kMinBiasPoints) return std::nullopt;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

void SaveDepth(const std::filesystem::path& path, const std::string& key, const DepthMap& map) {
  cv::Mat steps, sigma_steps, colour = map.colour.clone();
  cv::Mat smoothed_pct = map.smoothed_pct.empty()
                             ? cv::Mat(map.disparity.size(), CV_8UC1, cv::Scalar(0))
                             : map.smoothed_pct.clone();
  const cv::Mat unknown = map.disparity == 0.0F;
  const double steps_per_px = StepsPerPixel(map.disparity);
  map.disparity.convertTo(steps, CV_16U, steps_per_px);
  map.disparity_sigma.convertTo(sigma_steps, CV_8U, kStoredSigmaSteps);
  sigma_steps = cv::max(sigma_steps, 1);
  sigma_steps.setTo(0, unknown);
  smoothed_pct.setTo(0, unknown);
  colour.setTo(cv::Scalar::all(0), unknown);
  const StoredDepth stored{map.stamp_ns,      map.camera,         map.left_from_rectified,
                           map.baseline_m,    steps_per_px,       Pack(steps),
                           Pack(sigma_steps), Pack(smoothed_pct), Pack(colour)};
  WriteArtefact(path, key, stored);
}

std::optional<DepthMap> LoadDepth(const std::filesystem::path& path, const std::string& key) {
  const auto stored = ReadArtefact<StoredDepth>(path, key);
  if (!stored) return std::nullopt;
  DepthMap map{stored->stamp_ns,
               stored->camera,
               stored->left_from_rectified,
               stored->baseline_m,
               {},
               {},
               {},
               {}};
  const cv::Size size(stored->camera.width, stored->camera.height);
  const cv::Mat steps = Unpack(stored->disparity, size, CV_16UC1);
  const cv::Mat sigma_steps = Unpack(stored->sigma, size, CV_8UC1);
  map.smoothed_pct = Unpack(stored->smoothed, size, CV_8UC1);
  map.colour = Unpack(stored->colour, size, CV_8UC3);
  if (steps.empty() || sigma_steps.empty() || map.smoothed_pct.empty() || map.colour.empty()) {
    return std::nullopt;
  }
  steps.convertTo(map.disparity, CV_32F, 1.0 / stored->steps_per_px);
  sigma_steps.convertTo(map.disparity_sigma, CV_32F, 1.0 / kStoredSigmaSteps);
  return map;
}

DepthMap ReadDepth(const std::filesystem::path& path, const std::string& key) {
  std::optional<DepthMap> map = LoadDepth(path, key);
  if (map) return std::move(*map);
  throw DataError(
      fmt::format("{}: expected the depth map with key {}, found none or a damaged one; run again "
                  "with --from dense",
                  path.string(), key));
}

}  // namespace rigmap
