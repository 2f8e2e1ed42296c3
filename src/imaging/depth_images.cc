#include "imaging/depth_images.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "core/file.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

cv::Mat Unknown(const DepthMap& map) {
  return (map.disparity <= 0.0F) | (map.disparity_sigma >= kUnsurePx);
}

}  // namespace

cv::Mat DepthImage(const DepthMap& map, float unknown) {
  cv::Mat depth = map.camera.fx * map.baseline_m / map.disparity;
  depth.setTo(unknown, Unknown(map));
  return depth;
}

void WriteDepthImages(const DepthMap& map, const fs::path& folder) {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat depth = DepthImage(map, kNothing);
  cv::Mat sigma = depth.mul(map.disparity_sigma) / map.disparity;
  sigma.setTo(kNothing, Unknown(map));
  WriteImage(folder / fmt::format("{}.tif", map.stamp_ns), depth);
  WriteImage(folder / fmt::format("{}.sigma.tif", map.stamp_ns), sigma);
}

void WriteDepthCamera(const DepthMap& map, const fs::path& folder) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn =
      map.left_from_rectified.rotation.toRotationMatrix();
  const nlohmann::ordered_json camera = {
      {"width", map.camera.width},
      {"height", map.camera.height},
      {"fx", map.camera.fx},
      {"fy", map.camera.fy},
      {"cx", map.camera.cx},
      {"cy", map.camera.cy},
      {"left_from_depth", std::vector<double>(turn.data(), turn.data() + turn.size())}};
  WriteFileAtomically(folder / "camera.json",
                      [&](std::ostream& stream) { stream << camera.dump(2) << '\n'; });
}

}  // namespace rigmap
