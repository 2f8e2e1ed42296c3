#include "simulation/boulders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "simulation/internal/debris.h"
#include "simulation/scene_options.h"
#include "tests/simulation/mesh_checks.h"

namespace rigmap {
namespace {

constexpr double kFloat_m = 1e-5;  // what single precision leaves of a place

std::vector<Eigen::Vector2d> Way() {
  std::vector<Eigen::Vector2d> way;
  for (int i = 0; i <= 60; ++i) way.emplace_back(0.25 * i, std::sin(0.2 * i));
  return way;
}

const Terrain& Beach() {
  static const Terrain terrain(TerrainOptions{});
  return terrain;
}

const std::vector<Boulder>& ManyBoulders() {
  static const auto boulders = ScatterBoulders(Beach(), Way(), 14.0, 9);
  return boulders;
}

double WidthOf(const Boulder& boulder) {
  double widest_m = 0.0;
  for (const auto& vertex : boulder.mesh.vertices) {
    const Eigen::Vector2d out = vertex.head<2>().cast<double>() - boulder.centre.head<2>();
    widest_m = std::max(widest_m, 2.0 * out.norm());
  }
  return widest_m;
}

TEST(Boulders, ComeInThreeExactSizes) {
  const std::map<std::string, std::pair<double, double>> height_and_width{
      {"small", {0.30, 0.44}}, {"medium", {0.55, 0.80}}, {"large", {0.80, 1.10}}};
  std::map<std::string, int> counts;
  for (const Boulder& boulder : ManyBoulders()) {
    ++counts[boulder.size];
    const auto& [height_m, width_m] = height_and_width.at(boulder.size);
    EXPECT_EQ(boulder.height_m, height_m);
    EXPECT_EQ(boulder.width_m, width_m);
    EXPECT_NEAR(WidthOf(boulder), width_m, kFloat_m);
    const auto highest = std::ranges::max_element(
        boulder.mesh.vertices, {}, [](const Eigen::Vector3f& vertex) { return vertex.z(); });
    EXPECT_NEAR(highest->z(), boulder.centre.z() + height_m, kFloat_m);
    EXPECT_LT((highest->cast<double>() - boulder.top).norm(), kFloat_m);
  }
  EXPECT_EQ(counts.size(), 3u);
  EXPECT_GT(counts["small"], counts["large"]);
}

TEST(Boulders, AreClosedSolidsWithTheirFootInTheSand) {
  for (const Boulder& boulder : ManyBoulders()) {
    EXPECT_TRUE(IsClosed(boulder.mesh));
    const double box_m3 = boulder.width_m * boulder.width_m * boulder.height_m;
    EXPECT_GT(VolumeOf(boulder.mesh), 0.3 * box_m3);
    EXPECT_LT(VolumeOf(boulder.mesh), 1.3 * box_m3);
    EXPECT_EQ(boulder.centre.z(), Beach().Height(boulder.centre.x(), boulder.centre.y()));
    // In each of twelve directions some of it is below the sand.
    std::array<double, 12> deepest_m;
    deepest_m.fill(1.0);
    for (const auto& vertex : boulder.mesh.vertices) {
      const Eigen::Vector2d out = vertex.head<2>().cast<double>() - boulder.centre.head<2>();
      const double turn = std::atan2(out.y(), out.x()) / (2.0 * EIGEN_PI) + 0.5;
      double& deepest = deepest_m[std::min(11, static_cast<int>(12.0 * turn))];
      deepest = std::min(deepest, vertex.z() - Beach().Height(vertex.x(), vertex.y()));
    }
    for (const double depth_m : deepest_m) EXPECT_LT(depth_m, 0.0);
  }
}

TEST(Boulders, LeaveTheWayFreeAndStandApart) {
  const auto way = Way();
  double nearest_m = 1e9;
  for (std::size_t i = 0; i < ManyBoulders().size(); ++i) {
    const Boulder& boulder = ManyBoulders()[i];
    double from_way_m = 1e9;
    for (const auto& position : way) {
      from_way_m = std::min(from_way_m, (position - boulder.centre.head<2>()).norm());
    }
    EXPECT_GE(from_way_m, 0.5 * boulder.width_m + 0.95);
    EXPECT_LE(from_way_m, 7.0);
    nearest_m = std::min(nearest_m, from_way_m);
    for (std::size_t k = 0; k < i; ++k) {
      const Boulder& other = ManyBoulders()[k];
      EXPECT_GT((other.centre - boulder.centre).head<2>().norm(),
                0.5 * (other.width_m + boulder.width_m));
    }
  }
  EXPECT_LT(nearest_m, 2.0);
}

TEST(Boulders, AreAsManyAsAskedForAndDifferFromEachOther) {
  const auto& boulders = ManyBoulders();
  EXPECT_NEAR(static_cast<double>(boulders.size()), 14.0 * 3.7, 6.0);  // of about 370 m2
  EXPECT_TRUE(ScatterBoulders(Beach(), Way(), 0.0, 9).empty());
  EXPECT_TRUE(ScatterBoulders(Beach(), {}, 14.0, 9).empty());
  EXPECT_NEAR(static_cast<double>(ScatterBoulders(Beach(), Way(), 7.0, 9).size()),
              0.5 * static_cast<double>(boulders.size()), 2.0);
  const auto shape = [](const Boulder& boulder) {
    return VolumeOf(boulder.mesh) / (boulder.width_m * boulder.width_m * boulder.height_m);
  };
  const auto [least, most] = std::ranges::minmax(boulders, {}, shape);
  EXPECT_GT(shape(most), 1.05 * shape(least));
}

TEST(Boulders, EqualSeedsGiveEqualBoulders) {
  const auto again = ScatterBoulders(Beach(), Way(), 14.0, 9),
             other = ScatterBoulders(Beach(), Way(), 14.0, 10);
  ASSERT_EQ(again.size(), ManyBoulders().size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].top, ManyBoulders()[i].top);
    EXPECT_EQ(again[i].mesh.vertices, ManyBoulders()[i].mesh.vertices);
  }
  EXPECT_NE(other.front().centre, again.front().centre);
}

TEST(Boulders, RocksHaveMoreThanTheBeach) {
  const auto count = [](const std::string& name) {
    const SceneOptions scene = MakeScene(name, 4);
    return ScatterBoulders(Beach(), Way(), scene.boulders_per_100_m2, 4).size();
  };
  EXPECT_GT(count("rocks"), 2 * count("beach"));
  EXPECT_GT(count("beach"), 5u);
  EXPECT_EQ(count("flat-sand"), 0u);
}

TEST(Debris, IsSmallClosedAndHalfInTheSand) {
  const auto way = Way();
  const auto debris = StrewDebris(Beach(), way, 4.0, 6.0, 3);
  const double area_m2 = 4.0 * (2.0 * 15.5 + 3.1 * 4.0);
  EXPECT_NEAR(static_cast<double>(debris.size()), 6.0 * area_m2, 0.15 * 6.0 * area_m2);
  double shortest_m = 1.0, longest_m = 0.0;
  for (const Mesh& piece : debris) {
    EXPECT_TRUE(IsClosed(piece));
    EXPECT_GT(VolumeOf(piece), 0.0);
    double length_m = 0.0, lowest_m = 1e9, highest_m = -1e9;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& a : piece.vertices) {
      for (const auto& b : piece.vertices) length_m = std::max<double>(length_m, (a - b).norm());
      lowest_m = std::min<double>(lowest_m, a.z());
      highest_m = std::max<double>(highest_m, a.z());
      centre += a.cast<double>() / static_cast<double>(piece.vertices.size());
    }
    shortest_m = std::min(shortest_m, length_m);
    longest_m = std::max(longest_m, length_m);
    const double sand_m = Beach().Height(centre.x(), centre.y());
    EXPECT_LT(lowest_m, sand_m);
    EXPECT_GT(highest_m, sand_m);
    const bool is_near = std::ranges::any_of(
        way, [&](const auto& position) { return (position - centre.head<2>()).norm() < 4.01; });
    EXPECT_TRUE(is_near);
  }
  EXPECT_GT(shortest_m, 0.008);
  EXPECT_LT(shortest_m, 0.015);
  EXPECT_GT(longest_m, 0.08);
  EXPECT_LT(longest_m, 0.12);
}

}  // namespace
}  // namespace rigmap
