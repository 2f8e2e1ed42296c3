#include "fusion/internal/layered_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>
#include <utility>

namespace rigmap {
namespace {

constexpr std::int64_t kTileVoxels = 256;  // of the finest layer; all layers have the same tiles
static_assert(kTileVoxels % (1 << (LayeredGrid::kLayers - 1)) == 0);

struct Cell {
  std::int64_t x, y, z;

  friend bool operator==(const Cell&, const Cell&) = default;
};

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    constexpr std::uint64_t kOdd[] = {0x9E3779B97F4A7C15ULL, 0xC2B2AE3D27D4EB4FULL,
                                      0x165667B19E3779F9ULL};
    std::uint64_t hash = kOdd[0] * static_cast<std::uint64_t>(cell.x) ^
                         kOdd[1] * static_cast<std::uint64_t>(cell.y) ^
                         kOdd[2] * static_cast<std::uint64_t>(cell.z);
    return hash ^ (hash >> 29U);
  }
};

bool IsSteepNormal(const Eigen::Vector3f& normal) {
  constexpr float kSteep = 0.7071F;  // 45 degrees: beyond, more of it is seen from beside
  return normal.z() < kSteep;
}

}  // namespace

// In which cubes of each coarse layer finer points lie, by column of tiles, so that it can be
// forgotten where nothing will be asked any more.
class LayeredGrid::Cover {
 public:
  explicit Cover(double voxel_m) : voxel_m_(voxel_m) {}

  void Add(const SurfacePoint& point, int layer) {
    // Who lies in a cube lies in the larger ones around it.
    for (int coarser = layer + 1; coarser < kLayers; ++coarser) {
      const Cell cell = CellOf(point, coarser);
      if (!cells_[coarser][ColumnOf(cell.x, coarser)].insert(cell).second) return;
    }
  }
  // In the cube that the point lies in, or above, below or, of what is steep, beside it.
  bool Holds(const SurfacePoint& point, int layer) const {
    const Cell middle = CellOf(point, layer);
    const std::int64_t beside = IsSteepNormal(point.normal) ? 1 : 0;
    for (std::int64_t x = middle.x - beside; x <= middle.x + beside; ++x) {
      const auto column = cells_[layer].find(ColumnOf(x, layer));
      if (column == cells_[layer].end()) continue;
      for (std::int64_t y = middle.y - beside; y <= middle.y + beside; ++y) {
        for (std::int64_t z = middle.z - 1; z <= middle.z + 1; ++z) {
          if (column->second.contains({x, y, z})) return true;
        }
      }
    }
    return false;
  }
  void Forget(std::int64_t columns_before) {
    for (auto& columns : cells_) {
      columns.erase(columns.begin(), columns.lower_bound(columns_before));
    }
  }

 private:
  Cell CellOf(const SurfacePoint& point, int layer) const {
    const double side_m = std::ldexp(voxel_m_, layer);
    const Eigen::Array3d cell = (point.x_in_world.cast<double>().array() / side_m).floor();
    return {static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
            static_cast<std::int64_t>(cell.z())};
  }
  static std::int64_t ColumnOf(std::int64_t x, int layer) {
    return TileOfCell(x, kTileVoxels >> layer);
  }

  double voxel_m_;
  std::array<std::map<std::int64_t, std::unordered_set<Cell, CellHash>>, kLayers> cells_;
};

LayeredGrid::LayeredGrid(double voxel_m, double steep_voxel_share, std::filesystem::path scratch,
                         std::size_t most_voxels)
    : voxel_m_(voxel_m),
      steep_voxel_share_(steep_voxel_share),
      scratch_(std::move(scratch)),
      most_voxels_(most_voxels),
      steep_(steep_voxel_share * voxel_m, kTileVoxels * voxel_m, scratch_ / "steep",
             most_voxels / 2) {}

LayeredGrid::~LayeredGrid() {
  std::error_code ignored;
  std::filesystem::remove_all(scratch_, ignored);
}

bool LayeredGrid::IsSteep(const SurfaceSample& sample) { return IsSteepNormal(sample.normal); }

int LayeredGrid::LayerOf(const SurfaceSample& sample) const {
  const double cube_m = IsSteep(sample) ? steep_voxel_share_ * voxel_m_ : voxel_m_;
  if (sample.sigma_m <= kFineSigmas * voxel_m_ &&
      sample.sigma_m * sample.cosine <= kFineOff * cube_m &&
      sample.pixel_m <= kFinePixels * voxel_m_) {
    return 0;
  }
  const double side_m = std::max(sample.sigma_m, sample.pixel_m);
  const int layer = static_cast<int>(std::ceil(std::log2(side_m / voxel_m_)));
  return std::clamp(layer, 1, kLayers - 1);
}

TiledGrid& LayeredGrid::Layer(int layer) {
  const auto known = layers_.find(layer);
  if (known != layers_.end()) return known->second;
  const std::size_t most = most_voxels_ / (layer == 0 ? 3 : 6 * (kLayers - 1));
  return layers_
      .try_emplace(layer, std::ldexp(voxel_m_, layer), kTileVoxels * voxel_m_,
                   scratch_ / std::to_string(layer), most)
      .first->second;
}

void LayeredGrid::Add(std::span<const SurfaceSample> samples) {
  for (const SurfaceSample& sample : samples) {
    const int layer = LayerOf(sample);
    (layer == 0 && IsSteep(sample) ? steep_ : Layer(layer)).Add(sample);
  }
  steep_.SetAside();
  for (auto& [layer, grid] : layers_) grid.SetAside();
}

PointCloud LayeredGrid::Take(int layer, const TileIndex& tile, const FusionOptions& options) {
  const double most_m =
      options.max_sigma_m > 0.0 ? options.max_sigma_m : std::numeric_limits<double>::infinity();
  const auto grid = layers_.find(layer);
  PointCloud points;
  if (grid != layers_.end()) points = grid->second.Take(tile, options.min_observations, most_m);
  if (layer > 0) return points;
  // Smaller cubes hold fewer pixels.
  const int fewer = static_cast<int>(std::ceil(steep_voxel_share_ * options.min_observations));
  const PointCloud steep = steep_.Take(tile, fewer, most_m);
  points.insert(points.end(), steep.begin(), steep.end());
  return points;
}

void LayeredGrid::Drain(const FusionOptions& options,
                        const std::function<void(std::span<const SurfacePoint>)>& take) {
  std::map<std::int64_t, std::set<TileIndex>> columns;
  const auto note = [&](const TiledGrid& grid) {
    for (const TileIndex& tile : grid.Tiles()) columns[tile.first].insert(tile);
  };
  note(steep_);
  for (const auto& [layer, grid] : layers_) note(grid);
  std::vector<std::int64_t> order;
  for (const auto& [column, tiles] : columns) order.push_back(column);

  // Each layer asks for the finer ones in the columns beside its own: it comes a column later.
  Cover cover(voxel_m_);
  const std::size_t steps = order.size() + kLayers - 1;
  for (std::size_t step = 0; step < steps; ++step) {
    for (int layer = 0; layer < kLayers; ++layer) {
      if (step < static_cast<std::size_t>(layer) || step - layer >= order.size()) continue;
      for (const TileIndex& tile : columns[order[step - layer]]) {
        PointCloud points = Take(layer, tile, options);
        std::erase_if(points, [&](const SurfacePoint& point) {
          return layer > 0 && cover.Holds(point, layer);
        });
        for (const SurfacePoint& point : points) cover.Add(point, layer);
        take(points);
      }
    }
    if (step + 1 >= kLayers) cover.Forget(order[step + 1 - kLayers]);
  }
  layers_.clear();
}

}  // namespace rigmap
