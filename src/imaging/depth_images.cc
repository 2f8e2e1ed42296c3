#include "imaging/depth_images.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

void WriteTiff(const fs::path& path, const cv::Mat& image) {
  std::vector<uchar> bytes;
  if (!cv::imencode(".tif", image, bytes)) {
    throw DataError(fmt::format("{}: cannot encode the image", path.string()));
  }
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace

void WriteDepthImages(const DepthMap& map, const fs::path& folder) {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat unknown = (map.disparity <= 0.0F) | (map.disparity_sigma >= kUnsurePx);
  cv::Mat depth = map.camera.fx * map.baseline_m / map.disparity;
  cv::Mat sigma = depth.mul(map.disparity_sigma) / map.disparity;
  depth.setTo(kNothing, unknown);
  sigma.setTo(kNothing, unknown);
  WriteTiff(folder / fmt::format("{}.tif", map.stamp_ns), depth);
  WriteTiff(folder / fmt::format("{}.sigma.tif", map.stamp_ns), sigma);
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
