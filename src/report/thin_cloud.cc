#include "report/thin_cloud.h"

#include <algorithm>
#include <cmath>

#include "export/ply_reader.h"

namespace rigmap {
namespace {

template <class Get>
std::optional<double> MedianOf(const PointCloud& points, const Get& get) {
  std::vector<double> values;
  for (const SurfacePoint& point : points) {
    if (const double value = get(point); value > 0.0) values.push_back(value);
  }
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double SmallestGrain(const PointCloud& points) {
  double finest = 0.0;
  for (const SurfacePoint& point : points) {
    if (point.grain_m > 0.0F && (finest == 0.0 || point.grain_m < finest)) finest = point.grain_m;
  }
  return finest;
}

double CoveredArea(const HeightGrid& grid) {
  std::size_t cells = 0;
  for (const auto& [index, tile] : grid.tiles()) {
    cells += static_cast<std::size_t>(
        std::ranges::count_if(tile, [](const HeightCell& cell) { return cell.points > 0; }));
  }
  return static_cast<double>(cells) * kHeightCell_m * kHeightCell_m;
}

// A grid of the heights takes 35 kB a square metre: enough for a rover's map, too much for a
// street's, which tells of no rocks either.
constexpr double kFinestOfRocks_m = kHeightCell_m;
// What is wider is a house, a hedge or a car, and no field of rocks is around it.
constexpr double kWidestRock_m = 3.0;

bool AreRocks(const std::vector<SegmentedRock>& rocks) {
  return std::ranges::all_of(rocks, [](const auto& rock) { return rock.width_m <= kWidestRock_m; });
}

// Whether any point of the file is as fine; coarse ones may come first.
bool HasFinePoints(const std::filesystem::path& ply) {
  PlyReader reader(ply);
  PointCloud block;
  while (reader.Read(block)) {
    const double finest = SmallestGrain(block);
    if (finest > 0.0 && finest <= kFinestOfRocks_m * (1.0 + 1e-6)) return true;
  }
  return false;
}

}  // namespace

ThinCloud ReadThinCloud(const std::filesystem::path& ply, std::size_t max_points) {
  PlyReader reader(ply);
  ThinCloud cloud{.count_in_map = reader.point_count()};
  const double share =
      std::min(1.0, static_cast<double>(max_points) /
                        static_cast<double>(std::max<std::uint64_t>(cloud.count_in_map, 1)));
  HeightGrid heights;
  const bool is_fine = HasFinePoints(ply);
  std::uint64_t index = 0;
  PointCloud block;
  while (reader.Read(block)) {
    if (is_fine) heights.Add(block);
    for (const SurfacePoint& point : block) {
      const auto before = static_cast<std::uint64_t>(share * static_cast<double>(index));
      const auto after = static_cast<std::uint64_t>(share * static_cast<double>(++index));
      if (after > before && point.x_in_world.allFinite()) cloud.points.push_back(point);
    }
  }
  cloud.finest_m = SmallestGrain(cloud.points);
  cloud.median_sigma_m = MedianOf(cloud.points, [](const auto& point) { return point.sigma_m; });
  cloud.median_observations =
      MedianOf(cloud.points, [](const auto& point) { return point.observations; });
  if (is_fine && !cloud.points.empty()) {
    cloud.area_m2 = CoveredArea(heights);
    if (auto rocks = SegmentRocks(heights).rocks; AreRocks(rocks)) cloud.rocks = std::move(rocks);
  }
  return cloud;
}

}  // namespace rigmap
