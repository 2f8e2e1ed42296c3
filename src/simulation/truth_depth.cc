#include "simulation/internal/truth_depth.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

constexpr double kFocalStep_px = 100.0;
constexpr int kMargin_px = 4;

// The largest |x/z| and |y/z| of the undistorted rays along the image's border.
Eigen::Vector2d Reach(const Camera& camera) {
  Eigen::Vector2d reach = Eigen::Vector2d::Zero();
  const auto extend = [&](double x, double y) {
    const auto normalised = Undistort(camera, {x, y});
    if (normalised) reach = reach.cwiseMax(normalised->cwiseAbs());
  };
  for (int x = 0; x <= camera.width; ++x) {
    for (const double y : {-0.5, camera.height - 0.5}) extend(x - 0.5, y);
  }
  for (int y = 0; y <= camera.height; ++y) {
    for (const double x : {-0.5, camera.width - 0.5}) extend(x, y - 0.5);
  }
  return reach;
}

}  // namespace

Camera TruthDepthCamera(const StereoRig& rig) {
  const Eigen::Vector2d reach = Reach(rig.left.camera).cwiseMax(Reach(rig.right.camera));
  const double focal_px = kFocalStep_px * std::ceil(rig.left.camera.MeanFocal() / kFocalStep_px);
  const auto half_px = [&](double extent) {
    return static_cast<int>(std::ceil(focal_px * extent)) + kMargin_px;
  };
  Camera view;
  view.width = 2 * half_px(reach.x());
  view.height = 2 * half_px(reach.y());
  view.fx = view.fy = focal_px;
  view.cx = 0.5 * (view.width - 1);
  view.cy = 0.5 * (view.height - 1);
  return view;
}

cv::Mat RenderTruthDepth(const World& world, const Camera& view, const Rigid3& world_from_left) {
  cv::Mat depth = cv::Mat::zeros(view.height, view.width, CV_16UC1);
  const Eigen::Matrix3d world_from_left_axes = world_from_left.rotation.toRotationMatrix();
  tbb::parallel_for(0, view.height, [&](int row) {
    auto* pixel = depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < view.width; ++column) {
      const Eigen::Vector3d ray((column - view.cx) / view.fx, (row - view.cy) / view.fy, 1.0);
      const double length = ray.norm();
      const auto hit = world.Cast(world_from_left.translation, world_from_left_axes * ray / length);
      if (!hit) continue;
      const double units = std::round(hit->distance_m / length / kTruthDepthUnit_m);
      if (units <= std::numeric_limits<std::uint16_t>::max()) {
        pixel[column] = static_cast<std::uint16_t>(units);
      }
    }
  });
  return depth;
}

void WriteTruthDepth(const std::filesystem::path& folder, int frame, const cv::Mat& depth) {
  const auto path = folder / fmt::format("depth_{:04}.png", frame);
  std::vector<uchar> png;
  if (!cv::imencode(".png", depth, png)) {
    throw DataError(fmt::format("{}: cannot encode a depth map", path.string()));
  }
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(png.data()),
                 static_cast<std::streamsize>(png.size()));
  });
}

void WriteTruthDepthCamera(const std::filesystem::path& folder, const Camera& view) {
  const nlohmann::ordered_json json{
      {"fx", view.fx},
      {"fy", view.fy},
      {"cx", view.cx},
      {"cy", view.cy},
      {"unit_m", kTruthDepthUnit_m},
      {"invalid", 0},
      {"value", "z along the optical axis of the undistorted left camera"}};
  WriteFileAtomically(folder / "camera.json",
                      [&](std::ostream& stream) { stream << json.dump() << '\n'; });
}

}  // namespace rigmap
