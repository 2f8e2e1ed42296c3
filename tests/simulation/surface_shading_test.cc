#include "simulation/surface_shading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/internal/world_parts.h"
#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kElevation_rad = 0.5;

// Level ground along x under a sun in the east, with a ball of radius 0.3 m at the origin.
class LightOnGround : public testing::Test {
 protected:
  LightOnGround() {
    Mesh ball = Icosphere(4);
    for (auto& vertex : ball.vertices) vertex *= 0.3f;
    scene_.AddMesh(ball);
    scene_.AddMesh(Ground({-5.0, 0.0}));
    scene_.Commit();
  }
  // A small level square about a place.
  static Mesh Ground(const Eigen::Vector2d& position) {
    Mesh mesh;
    for (int i = 0; i < 4; ++i) {
      mesh.vertices.emplace_back(position.x() + 1e-3 * (i % 2), position.y() + 1e-3 * (i / 2), 0.0);
    }
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    return mesh;
  }
  Light At(double x_m, double y_m) const {
    return LightOnMesh(Ground({x_m, y_m}), {sun_, &scene_}).front();
  }

  RayScene scene_;
  const Eigen::Vector3f sun_{static_cast<float>(std::cos(kElevation_rad)), 0.0f,
                             static_cast<float>(std::sin(kElevation_rad))};
};

TEST_F(LightOnGround, OpenGroundHasAllOfSunAndSky) {
  const Light light = At(-5.0, 0.0);
  EXPECT_EQ(light.visible, 1.0f);
  EXPECT_NEAR(light.sun, std::sin(kElevation_rad), 1e-5);
  EXPECT_NEAR(light.sky, 1.0f, 1e-5f);
}

TEST_F(LightOnGround, BallThrowsAShadowAwayFromTheSun) {
  const double shadow_end_m = 0.3 / std::sin(kElevation_rad);
  for (const double x_m : {0.35, 0.45, 0.55}) {
    const Light dark = At(-x_m, 0.0), lit = At(x_m, 0.0);
    EXPECT_EQ(dark.visible, 0.0f);
    EXPECT_EQ(dark.sun, 0.0f);
    EXPECT_GT(dark.sky, 0.0f);
    EXPECT_EQ(lit.visible, 1.0f);
  }
  EXPECT_EQ(At(-shadow_end_m - 0.05, 0.0).visible, 1.0f);
  EXPECT_EQ(At(-0.45, 0.35).visible, 1.0f);
}

TEST_F(LightOnGround, ShadowsEdgeIsSoftAndMonotone) {
  const double shadow_end_m = 0.3 / std::sin(kElevation_rad);
  float last = 0.0f;
  int between = 0;
  for (double x_m = shadow_end_m - 0.05; x_m < shadow_end_m + 0.05; x_m += 0.001) {
    const float visible = At(-x_m, 0.0).visible;
    EXPECT_GE(visible, last);
    between += visible > 0.0f && visible < 1.0f;
    last = visible;
  }
  EXPECT_EQ(last, 1.0f);
  EXPECT_GT(between, 5);  // millimetres
}

TEST_F(LightOnGround, FarSideOfABallIsDarkAndNearSideBright) {
  Mesh ball = Icosphere(2);
  for (auto& vertex : ball.vertices) vertex = 0.3f * vertex + Eigen::Vector3f(0.0f, 9.0f, 0.0f);
  RayScene scene;
  scene.AddMesh(ball);
  scene.Commit();
  const auto normals = ball.VertexNormals();
  const auto lights = LightOnMesh(ball, {sun_, &scene});
  ASSERT_EQ(lights.size(), ball.vertices.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const float cosine = normals[i].dot(sun_);
    EXPECT_NEAR(lights[i].sky, 0.5f * (1.0f + normals[i].z()), 1e-5f);
    if (cosine < 0.0f) {
      EXPECT_EQ(lights[i].sun, 0.0f);
    } else if (cosine > 0.2f) {
      EXPECT_NEAR(lights[i].sun, cosine, 1e-5f);
    }
  }
}

constexpr float kRounding = 1e-5f;  // of single precision

void ExpectNear(const SandState& a, const SandState& b, float tolerance) {
  EXPECT_NEAR(a.light.sun, b.light.sun, tolerance);
  EXPECT_NEAR(a.light.visible, b.light.visible, tolerance);
  EXPECT_NEAR(a.light.sky, b.light.sky, tolerance);
  EXPECT_NEAR(a.tone, b.tone, tolerance);
}

TEST(SandStates, CoarserLevelsAreMeansOfFinerOnes) {
  const auto& parts = SmallWorld().parts();
  const std::uint32_t index = parts.tiles.TileAt({1.0, 0.5});
  const SandTile& tile = parts.tiles.tiles()[index];
  constexpr std::array<float, 3> kWeights{0.25f, 0.5f, 0.25f};
  SeededRandom random;
  float spread = 0.0f;
  for (int i = 0; i < 600; ++i) {
    const int level = 1 + i % 5;
    const double step_m = tile.cell_m * (1 << (level - 1));
    const auto inner = (SandTiles::kCells >> level) - 1;
    const Eigen::Vector2d position =
        tile.corner + 2.0 * step_m *
                          Eigen::Vector2d(1.0 + std::floor(random.Uniform(0.0, inner)),
                                          1.0 + std::floor(random.Uniform(0.0, inner)));
    SandState mean{.light = {}, .tone = 0.0f};
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector2d at = position + step_m * Eigen::Vector2d(k % 3 - 1, k / 3 - 1);
      const SandState fine = parts.sand->At(index, at, static_cast<float>(step_m));
      const float weight = kWeights[k % 3] * kWeights[k / 3];
      mean.light.sun += weight * fine.light.sun;
      mean.light.visible += weight * fine.light.visible;
      mean.light.sky += weight * fine.light.sky;
      mean.tone += weight * fine.tone;
      spread = std::max(spread, std::abs(fine.light.sun - mean.light.sun));
    }
    ExpectNear(parts.sand->At(index, position, static_cast<float>(2.0 * step_m)), mean, kRounding);
  }
  EXPECT_GT(spread, 0.01f);
}

TEST(SandStates, LieBetweenTheirNodesAndBetweenTheirLevels) {
  const auto& parts = SmallWorld().parts();
  const std::uint32_t index = parts.tiles.TileAt({1.0, 0.5});
  const SandTile& tile = parts.tiles.tiles()[index];
  const auto cell_m = static_cast<float>(tile.cell_m);
  SeededRandom random;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d node =
        tile.corner + tile.cell_m * Eigen::Vector2d(std::floor(random.Uniform(0.0, 63.0)),
                                                    std::floor(random.Uniform(0.0, 64.0)));
    const Eigen::Vector2d next = node + Eigen::Vector2d(tile.cell_m, 0.0);
    const auto sun = [&](const Eigen::Vector2d& at, float extent_m) {
      return parts.sand->At(index, at, extent_m).light.sun;
    };
    EXPECT_NEAR(sun(0.5 * (node + next), cell_m), 0.5f * (sun(node, cell_m) + sun(next, cell_m)),
                kRounding);
    float last = sun(node, cell_m);
    const float coarse = sun(node, 2.0f * cell_m), up = coarse > last ? 1.0f : -1.0f;
    for (const float width : {1.25f, 1.5f, 1.75f}) {
      const float between = sun(node, width * cell_m);
      EXPECT_GE(up * (between - last), -kRounding);
      EXPECT_LE(up * (between - coarse), kRounding);
      last = between;
    }
    EXPECT_EQ(sun(node, 0.1f * cell_m), sun(node, cell_m));
  }
}

TEST(SandStates, AgreeAcrossTheBorderOfTiles) {
  const auto& parts = SmallWorld().parts();
  const std::uint32_t west = parts.tiles.TileAt({1.0, 0.5});
  const SandTile& tile = parts.tiles.tiles()[west];
  const double border_m = tile.corner.x() + SandTiles::kCells * tile.cell_m;
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const double y_m = tile.corner.y() + random.Uniform(0.0, SandTiles::kCells * tile.cell_m);
    const Eigen::Vector2d here(border_m - 1e-7, y_m), there(border_m + 1e-7, y_m);
    const std::uint32_t east = parts.tiles.TileAt(there);
    ASSERT_NE(west, east);
    if (parts.tiles.tiles()[east].cell_m != tile.cell_m) continue;
    const auto cell_m = static_cast<float>(tile.cell_m);
    ExpectNear(parts.sand->At(west, here, cell_m), parts.sand->At(east, there, cell_m), kRounding);
    // Asked of the wrong tile, it is looked up in the right one.
    ExpectNear(parts.sand->At(west, there, cell_m), parts.sand->At(east, there, cell_m), 0.0f);
  }
}

}  // namespace
}  // namespace rigmap
