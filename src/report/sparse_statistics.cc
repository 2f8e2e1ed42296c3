#include "report/sparse_statistics.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <unordered_map>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kMatrixSide = 48;
constexpr std::size_t kMinResiduals = 10;

StampNs StampOfName(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  StampNs stamp_ns = 0;
  std::from_chars(stem.data(), stem.data() + stem.size(), stamp_ns);
  return stamp_ns;
}

using PointPositions = std::unordered_map<std::uint64_t, Eigen::Vector3d>;

void AddToField(const Eigen::Vector2d& pixel, const Eigen::Vector2d& residual,
                SparseStatistics& statistics) {
  const int column = std::clamp(static_cast<int>(pixel.x() * kResidualColumns / statistics.width),
                                0, kResidualColumns - 1);
  const int row = std::clamp(static_cast<int>(pixel.y() * kResidualRows / statistics.height), 0,
                             kResidualRows - 1);
  ResidualCell& cell = statistics.field[static_cast<std::size_t>(row * kResidualColumns + column)];
  ++cell.count;
  cell.mean_px += (residual - cell.mean_px) / static_cast<double>(cell.count);
}

ImageStatistics AddImage(const SparseImage& image, const Camera& camera,
                         const PointPositions& points, SparseStatistics& statistics) {
  ImageStatistics found;
  std::vector<double> distances;
  for (const SparseKeypoint& keypoint : image.keypoints) {
    if (!keypoint.point_id) continue;
    ++found.points;
    const auto point = points.find(*keypoint.point_id);
    if (point == points.end()) continue;
    const auto pixel = Project(camera, image.camera_from_model * point->second);
    if (!pixel) continue;
    distances.push_back((keypoint.pixel - *pixel).norm());
    AddToField(keypoint.pixel, keypoint.pixel - *pixel, statistics);
  }
  if (distances.size() >= kMinResiduals) {
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    found.residual_px = *middle;
  }
  return found;
}

void PutMatrix(const SparseModel& model, SparseStatistics& statistics) {
  int last = -1;
  for (const SparseImage& image : model.images) last = std::max(last, image.ref.frame);
  if (last < 1) return;
  statistics.frames_per_group = last / kMatrixSide + 1;
  statistics.matrix_side = last / statistics.frames_per_group + 1;
  const auto side = static_cast<std::size_t>(statistics.matrix_side);
  statistics.matrix.assign(side * side, 0);
  for (const SparsePoint& point : model.points) {
    std::set<int> groups;
    for (const TrackElement& element : point.track) {
      groups.insert(element.image.frame / statistics.frames_per_group);
    }
    for (const int a : groups) {
      for (const int b : groups) {
        ++statistics.matrix[static_cast<std::size_t>(a) * side + static_cast<std::size_t>(b)];
      }
    }
  }
}

}  // namespace

const Camera* LeftCameraOf(const SparseModel& model) {
  for (const SparseCamera& camera : model.cameras) {
    if (camera.eye == Eye::kLeft) return &camera.camera;
  }
  return nullptr;
}

double MedianPointsOfImages(const SparseStatistics& statistics) {
  std::vector<std::size_t> counts;
  for (const auto& [stamp, image] : statistics.images) counts.push_back(image.points);
  return counts.empty() ? 0.0 : static_cast<double>(Median(std::move(counts)));
}

SparseStatistics StatisticsOf(const SparseModel& model) {
  SparseStatistics statistics{.points = model.points.size()};
  PointPositions positions;
  for (const SparsePoint& point : model.points) {
    positions.emplace(point.id, point.x_in_model);
    std::set<int> frames;
    for (const TrackElement& element : point.track) frames.insert(element.image.frame);
    ++statistics.tracks[static_cast<int>(frames.size())];
    statistics.observations += point.track.size();
  }
  PutMatrix(model, statistics);
  const Camera* camera = LeftCameraOf(model);
  if (!camera) return statistics;
  statistics.width = camera->width;
  statistics.height = camera->height;
  for (const SparseImage& image : model.images) {
    if (image.ref.eye != Eye::kLeft) continue;
    statistics.images[StampOfName(image.name)] = AddImage(image, *camera, positions, statistics);
  }
  return statistics;
}

}  // namespace rigmap
