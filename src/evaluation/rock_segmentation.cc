#include "evaluation/rock_segmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "core/statistics.h"
#include "export/ply_reader.h"

namespace rigmap {
namespace {

constexpr int kReachCells = 2;        // cells this far apart belong together
constexpr int kDirections = 36;       // in which a footprint is measured
constexpr std::size_t kAgreeing = 3;  // cells in three by three that a top is confirmed by

struct RockCell {
  double ground_z_m = 0.0;
  double top_z_m = 0.0;  // confirmed
  int points = 0;
  bool taken = false;
};
using RockCells = std::map<CellIndex, RockCell>;

// The cell's top, or the third highest of its neighbourhood if that is lower.
double ConfirmedTop(const HeightGrid& grid, const CellIndex& cell) {
  std::array<float, 9> tops;
  std::size_t count = 0;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const HeightCell* found = grid.Find({cell.first + dx, cell.second + dy});
      tops[count++] = found ? found->top_m : -std::numeric_limits<float>::infinity();
    }
  }
  std::nth_element(tops.begin(), tops.begin() + (kAgreeing - 1), tops.end(), std::greater<>());
  return std::min(tops[kAgreeing - 1], grid.Find(cell)->top_m);
}

template <class Visit>
void ForEachCellOverGround(const HeightGrid& grid, const GroundLevel& ground, const Visit& visit) {
  for (const auto& [tile, cells] : grid.tiles()) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].points == 0) continue;
      const CellIndex cell = CellOfTile(tile, i);
      const Eigen::Vector2d centre = CentreOf(cell);
      if (const auto level_m = ground.At(centre)) visit(cell, cells[i], *level_m);
    }
  }
}

double HeightLimit(const HeightGrid& grid, const GroundLevel& ground,
                   const RockSegmentationOptions& options) {
  std::vector<float> heights_m;
  ForEachCellOverGround(grid, ground,
                        [&](const CellIndex&, const HeightCell& cell, double level_m) {
                          heights_m.push_back(cell.mean_m - static_cast<float>(level_m));
                        });
  if (heights_m.empty()) return options.min_height_m;
  const double sigma_m = kSigmaOfMedianDeviation * MedianAbsolute(std::move(heights_m));
  return std::max(options.min_height_m, options.min_height_sigmas * sigma_m);
}

RockCells FindRockCells(const HeightGrid& grid, const GroundLevel& ground, double limit_m) {
  RockCells found;
  ForEachCellOverGround(grid, ground,
                        [&](const CellIndex& cell, const HeightCell& content, double level_m) {
                          if (content.top_m - level_m <= limit_m) return;
                          const double top_z_m = ConfirmedTop(grid, cell);
                          if (top_z_m - level_m <= limit_m) return;
                          found[cell] = {level_m, top_z_m, static_cast<int>(content.points)};
                        });
  return found;
}

// `start` and all that are connected to it; marks them as taken.
std::vector<CellIndex> TakeConnected(RockCells& cells, RockCells::iterator start) {
  std::vector<CellIndex> connected{start->first};
  start->second.taken = true;
  for (std::size_t next = 0; next < connected.size(); ++next) {
    const CellIndex from = connected[next];
    for (int dx = -kReachCells; dx <= kReachCells; ++dx) {
      for (int dy = -kReachCells; dy <= kReachCells; ++dy) {
        const auto neighbour = cells.find({from.first + dx, from.second + dy});
        if (neighbour == cells.end() || neighbour->second.taken) continue;
        neighbour->second.taken = true;
        connected.push_back(neighbour->first);
      }
    }
  }
  return connected;
}

double LargestExtent(const std::vector<CellIndex>& cells) {
  double largest_m = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle_rad = std::numbers::pi * i / kDirections;
    const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
    const auto [least, most] = std::ranges::minmax(
        cells, {}, [&](const CellIndex& cell) { return direction.dot(CentreOf(cell)); });
    largest_m = std::max(largest_m, direction.dot(CentreOf(most) - CentreOf(least)));
  }
  return largest_m + kHeightCell_m;
}

SegmentedRock Measure(const std::vector<CellIndex>& footprint, const RockCells& cells) {
  SegmentedRock rock;
  rock.top_z_m = -std::numeric_limits<double>::infinity();
  const double share = 1.0 / static_cast<double>(footprint.size());
  double ground_z_m = 0.0;
  for (const CellIndex& index : footprint) {
    const RockCell& cell = cells.at(index);
    rock.centre += share * CentreOf(index);
    rock.points += cell.points;
    rock.top_z_m = std::max(rock.top_z_m, cell.top_z_m);
    ground_z_m += share * cell.ground_z_m;
  }
  rock.height_m = rock.top_z_m - ground_z_m;
  rock.width_m = LargestExtent(footprint);
  return rock;
}

}  // namespace

OptionFields RockSegmentationOptions::Fields() {
  return {
      {"min_height_m", &min_height_m, "m", MoreThan(0.0),
       "Cells this far above the ground belong to rocks; footprints and tracks do not. A quarter "
       "of Katwijk's smallest rocks."},
      {"min_height_sigmas", &min_height_sigmas, "sigmas", AtLeast(0.0),
       "The same in sigmas of the heights about the ground, where the map is noisier than that."},
      {"min_top_m", &min_top_m, "m", AtLeast(0.0),
       "The top of a rock is at least so high: half of the smallest rocks' height."},
      {"min_width_m", &min_width_m, "m", AtLeast(0.0),
       "The footprint of a rock is at least so long: half of the smallest rocks' width, since the "
       "map may show one face only."},
  };
}

RockSegmentation SegmentRocks(const HeightGrid& grid, const RockSegmentationOptions& options) {
  RequireValid(options);
  RockSegmentation segmentation{.rocks = {}, .ground = GroundLevel(grid)};
  segmentation.height_limit_m = HeightLimit(grid, segmentation.ground, options);
  RockCells cells = FindRockCells(grid, segmentation.ground, segmentation.height_limit_m);
  for (auto cell = cells.begin(); cell != cells.end(); ++cell) {
    if (cell->second.taken) continue;
    const SegmentedRock rock = Measure(TakeConnected(cells, cell), cells);
    if (rock.height_m < options.min_top_m || rock.width_m < options.min_width_m) continue;
    segmentation.rocks.push_back(rock);
  }
  std::ranges::stable_sort(segmentation.rocks, std::ranges::greater(), &SegmentedRock::height_m);
  return segmentation;
}

RockSegmentation SegmentRocksIn(const std::filesystem::path& ply,
                                const RockSegmentationOptions& options) {
  HeightGrid grid;
  PlyReader reader(ply);
  PointCloud block;
  while (reader.Read(block)) grid.Add(block);
  return SegmentRocks(grid, options);
}

RockSegmentation SegmentRocks(const PointCloud& cloud, const RockSegmentationOptions& options) {
  HeightGrid grid;
  grid.Add(cloud);
  return SegmentRocks(grid, options);
}

}  // namespace rigmap
