#include "simulation/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "simulation/internal/world_parts.h"
#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

const Eigen::Vector3d kDown(0.0, 0.0, -1.0);

// Where a ray from high above meets the sand; nothing where something else lies on it.
std::optional<SurfaceHit> SandAt(const World& world, const Eigen::Vector2d& position) {
  const auto hit = world.Cast({position.x(), position.y(), 30.0}, kDown);
  EXPECT_TRUE(hit) << position.transpose();
  const bool is_sand =
      hit && (hit->kind == SurfaceKind::kSand || hit->kind == SurfaceKind::kCoarseSand);
  return is_sand ? hit : std::nullopt;
}

double CellAt(const World& world, const Eigen::Vector2d& position) {
  const SandTiles& tiles = world.parts().tiles;
  return tiles.tiles()[tiles.TileAt(position)].cell_m;
}

// How far a facet may lie from the terrain that its corners lie on: slopes stay below 1 in what a
// mesh of such cells is told of.
double FacetError_m(double cell_m) { return 1e-3 + 0.5 * cell_m; }

TEST(World, SandPassesThroughTheTerrainAtItsNodes) {
  const World& world = SmallWorld();
  int nodes = 0;
  for (int column = -60; column <= 100; column += 3) {
    for (int row = -80; row <= 80; row += 3) {
      const double x = column * kSmallCell_m, y = row * kSmallCell_m;
      if (std::hypot(x - std::clamp(x, 0.0, 2.0), y) > World::kFineSand_m) continue;
      const auto hit = SandAt(world, {x, y});
      if (!hit) continue;
      ++nodes;
      EXPECT_EQ(hit->kind, SurfaceKind::kSand);
      EXPECT_NEAR(hit->position.z(), world.terrain().Height(x, y, kSmallCell_m), kSmallNoise_m);
    }
  }
  EXPECT_GT(nodes, 1000);
}

TEST(World, SandIsTwoTrianglesBetweenFourNodes) {
  const World& world = SmallWorld();
  SeededRandom random;
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = kSmallCell_m * std::floor(random.Uniform(-40, 80)),
                 y = kSmallCell_m * std::floor(random.Uniform(-60, 60)),
                 u = random.Uniform(0.02, 0.98), v = random.Uniform(0.02, 0.98);
    const auto hit = SandAt(world, {x + u * kSmallCell_m, y + v * kSmallCell_m});
    if (!hit) continue;
    const auto at = [&](int dx, int dy) {
      return world.terrain().Height(x + dx * kSmallCell_m, y + dy * kSmallCell_m, kSmallCell_m);
    };
    // Cut along either diagonal.
    const double rising = u > v ? at(0, 0) + u * (at(1, 0) - at(0, 0)) + v * (at(1, 1) - at(1, 0))
                                : at(0, 0) + v * (at(0, 1) - at(0, 0)) + u * (at(1, 1) - at(0, 1));
    const double falling =
        u + v < 1.0 ? at(0, 0) + u * (at(1, 0) - at(0, 0)) + v * (at(0, 1) - at(0, 0))
                    : at(1, 1) + (1 - u) * (at(0, 1) - at(1, 1)) + (1 - v) * (at(1, 0) - at(1, 1));
    EXPECT_LT(std::min(std::abs(hit->position.z() - rising), std::abs(hit->position.z() - falling)),
              kSmallNoise_m);
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

TEST(World, SandHasNoHolesSeenFromAbove) {
  const World& world = SmallWorld();
  SeededRandom random;
  for (int i = 0; i < 40000; ++i) {
    const double angle = random.Uniform(0.0, 7.0), out_m = random.Uniform(0.0, 30.0);
    Eigen::Vector2d position = out_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const auto& tile = world.parts().tiles.tiles()[world.parts().tiles.TileAt(position)];
    // Half of them along the seams, where cells of different size meet.
    if (i % 2) position.x() = tile.corner.x() + random.Uniform(-1e-4, 1e-4);
    const auto hit = SandAt(world, position);
    if (!hit) continue;
    const double cell_m = CellAt(world, position);
    ASSERT_NEAR(hit->position.z(), world.terrain().Height(position.x(), position.y(), cell_m),
                FacetError_m(2.0 * cell_m))
        << position.transpose();
  }
}

TEST(World, SandHasNoHolesAtGrazingAngles) {
  const World& world = SmallWorld();
  SeededRandom random;
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const double azimuth = random.Uniform(0.0, 7.0), down = random.Uniform(0.04, 0.5);
    const Eigen::Vector3d origin(random.Uniform(0.0, 2.0), 0.0, 1.2);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), -down).normalized();
    const auto hit = world.Cast(origin, direction);
    ASSERT_TRUE(hit) << direction.transpose();
    EXPECT_NEAR((hit->position - origin).norm(), hit->distance_m, 1e-9);
    EXPECT_LT(hit->normal.dot(direction), 0.0);
    if (hit->kind != SurfaceKind::kSand && hit->kind != SurfaceKind::kCoarseSand) continue;
    const Eigen::Vector2d position = hit->position.head<2>();
    const double cell_m = CellAt(world, position);
    ASSERT_NEAR(hit->position.z(), world.terrain().Height(position.x(), position.y(), cell_m),
                FacetError_m(2.0 * cell_m))
        << direction.transpose();
    far += hit->distance_m > 15.0;
  }
  EXPECT_GT(far, 500);
}

TEST(World, IsOccludedWhereARayMeetsSomethingFirst) {
  const World& world = SmallWorld();
  SeededRandom random;
  int occluded = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d from(random.Uniform(0, 2), random.Uniform(-1, 1), 1.2),
        to(random.Uniform(-2, 4), random.Uniform(-4, 4), random.Uniform(-0.3, 1.2));
    const double distance_m = (to - from).norm();
    const auto hit = world.Cast(from, (to - from) / distance_m);
    const bool expected = hit && hit->distance_m < distance_m - 1e-3;
    if (hit && std::abs(hit->distance_m - distance_m) < 2e-3) continue;
    EXPECT_EQ(world.IsOccluded(from, to), expected);
    EXPECT_EQ(world.IsOccluded(from, to), world.IsOccluded(to, from));
    occluded += expected;
  }
  EXPECT_GT(occluded, 300);
}

TEST(World, BoulderStandsWhereItsMeshIs) {
  const World& world = SmallWorld();
  ASSERT_FALSE(world.boulders().empty());
  for (const Boulder& boulder : world.boulders()) {
    const auto hit = world.Cast(boulder.top + Eigen::Vector3d(0.0, 0.0, 5.0), kDown);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->kind, SurfaceKind::kRock);
    EXPECT_NEAR(hit->position.z(), boulder.top.z(), 1e-3);
  }
}

SceneOptions Coarse(const std::string& name, std::uint64_t seed) {
  SceneOptions scene = MakeScene(name, seed);
  scene.sand_cell_m = 0.1;
  return scene;
}

TEST(World, EqualOptionsGiveAnEqualWorldAndSeedsDiffer) {
  const SceneOptions options = Coarse("beach", 3);
  const World a(options, SmallOutline()), b(options, SmallOutline()),
      other(Coarse("beach", 4), SmallOutline());
  ASSERT_EQ(a.boulders().size(), b.boulders().size());
  ASSERT_EQ(a.debris().size(), b.debris().size());
  SeededRandom random;
  int different = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d origin(random.Uniform(-5, 5), random.Uniform(-5, 5), 10.0);
    const auto hit_a = a.Cast(origin, kDown), hit_b = b.Cast(origin, kDown);
    ASSERT_TRUE(hit_a && hit_b);
    EXPECT_EQ(hit_a->distance_m, hit_b->distance_m);
    different += std::abs(hit_a->distance_m - other.Cast(origin, kDown)->distance_m) > 1e-3;
  }
  EXPECT_GT(different, 400);
}

TEST(World, DunesAndTheSeaLieBeyondTheWay) {
  for (const double far_m : {-150.0, 150.0}) {
    const std::vector<Eigen::Vector2d> outline{{far_m, 0.0}, {far_m, 0.4}};
    const World world(Coarse("beach", 2), outline);
    for (double aside_m = -5.0; aside_m <= 5.0; aside_m += 0.5) {
      const auto hit = world.Cast({far_m + aside_m, 0.2, 30.0}, kDown);
      ASSERT_TRUE(hit);
      EXPECT_NE(hit->kind, SurfaceKind::kSea) << far_m + aside_m;
      EXPECT_NE(hit->kind, SurfaceKind::kDune) << far_m + aside_m;
      EXPECT_LT(std::abs(hit->position.z()), 0.9) << far_m + aside_m;
    }
  }
}

TEST(World, FlatSandIsFlatAndBare) {
  const World world(Coarse("flat-sand", 2), SmallOutline());
  EXPECT_TRUE(world.boulders().empty());
  EXPECT_TRUE(world.debris().empty());
  double lowest_m = 1.0, highest_m = -1.0;
  for (double x = -30.0; x < 30.0; x += 0.23) {
    for (double y = -30.0; y < 30.0; y += 0.23) {
      lowest_m = std::min(lowest_m, world.terrain().Height(x, y));
      highest_m = std::max(highest_m, world.terrain().Height(x, y));
    }
  }
  EXPECT_LT(highest_m - lowest_m, 0.02);
  EXPECT_GT(highest_m - lowest_m, 0.002);
}

TEST(World, MarkersLieFlatJustAboveTheSand) {
  SceneOptions options = Coarse("beach", 6);
  options.boulders_per_100_m2 = options.debris_per_m2 = 0.0;
  options.markers = 25;
  const World world(options, SmallOutline());
  ASSERT_EQ(world.markers().size(), 25u);
  for (const Eigen::Vector3d& centre : world.markers()) {
    for (int i = 0; i < 24; ++i) {
      const double out_m = (i % 3) * 1.2 * World::kMarkerRadius_m;
      const Eigen::Vector3d position =
          centre + Eigen::Vector3d(out_m * std::cos(i), out_m * std::sin(i), 0.0);
      const auto hit = world.Cast(position + Eigen::Vector3d(0.0, 0.0, 2.0), kDown);
      ASSERT_TRUE(hit);
      EXPECT_EQ(hit->kind, SurfaceKind::kMarker);
      if (i % 3 == 0) {
        EXPECT_GE(hit->position.z(), centre.z() - kSmallNoise_m);
      }
      const double gap_m = centre.z() - world.terrain().Height(position.x(), position.y());
      EXPECT_GT(gap_m, 0.0);
      EXPECT_LT(gap_m, 0.2);
    }
  }
}

}  // namespace
}  // namespace rigmap
