#include "colmap/internal/camera_model.h"

#include <fmt/format.h>

#include <array>

namespace rigmap {
namespace {

constexpr int kPinhole = 1;
constexpr int kOpenCv = 4;
constexpr int kFullOpenCv = 6;
constexpr std::array kNames{"SIMPLE_PINHOLE",
                            "PINHOLE",
                            "SIMPLE_RADIAL",
                            "RADIAL",
                            "OPENCV",
                            "OPENCV_FISHEYE",
                            "FULL_OPENCV",
                            "FOV",
                            "SIMPLE_RADIAL_FISHEYE",
                            "RADIAL_FISHEYE",
                            "THIN_PRISM_FISHEYE"};

}  // namespace

ColmapCamera ToColmap(const Camera& camera) {
  ColmapCamera result{.model = kPinhole,
                      .parameters = {camera.fx, camera.fy, camera.cx + kColmapPixelShift,
                                     camera.cy + kColmapPixelShift}};
  if (camera.IsPinhole()) return result;
  result.model = kOpenCv;
  for (const double value : {camera.k1, camera.k2, camera.p1, camera.p2}) {
    result.parameters.push_back(value);
  }
  if (camera.k3 == 0.0) return result;
  result.model = kFullOpenCv;
  for (const double value : {camera.k3, 0.0, 0.0, 0.0}) result.parameters.push_back(value);
  return result;
}

std::optional<std::size_t> ParameterCount(int model) {
  if (model == kPinhole) return 4;
  if (model == kOpenCv) return 8;
  if (model == kFullOpenCv) return 12;
  return std::nullopt;
}

Camera FromColmap(const ColmapCamera& colmap_camera, int width, int height) {
  const auto& values = colmap_camera.parameters;
  Camera camera{.width = width, .height = height};
  camera.fx = values.at(0);
  camera.fy = values.at(1);
  camera.cx = values.at(2) - kColmapPixelShift;
  camera.cy = values.at(3) - kColmapPixelShift;
  if (colmap_camera.model == kPinhole) return camera;
  camera.k1 = values.at(4);
  camera.k2 = values.at(5);
  camera.p1 = values.at(6);
  camera.p2 = values.at(7);
  if (colmap_camera.model == kFullOpenCv) camera.k3 = values.at(8);
  return camera;
}

std::string ModelName(int model) {
  const bool known = model >= 0 && model < static_cast<int>(kNames.size());
  return fmt::format("{} ({})", known ? kNames[static_cast<std::size_t>(model)] : "unknown", model);
}

}  // namespace rigmap
