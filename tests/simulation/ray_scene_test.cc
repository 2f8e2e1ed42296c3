#include "simulation/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

// A sphere of radius 1 about (0, 0, 3), above a ground plane of 8 x 8 m made of two grids.
class RayScenes : public testing::Test {
 protected:
  RayScenes() {
    Mesh ball = Icosphere(4);
    for (auto& vertex : ball.vertices) vertex.z() += 3.0f;
    ball_ = scene_.AddMesh(ball);
    std::vector<Eigen::Vector3f> nodes;
    for (const float west : {-4.0f, 0.0f}) {
      for (int i = 0; i < 45; ++i) {
        nodes.emplace_back(west + 1.0f * static_cast<float>(i % 5),
                           -4.0f + 1.0f * static_cast<float>(i / 5), 0.0f);
      }
    }
    ground_ = scene_.AddGrids(nodes, {{0, 5, 9}, {45, 5, 9}});
    scene_.Commit();
  }
  static Eigen::Vector3f Direction(SeededRandom& random) {
    return random.Vector(1.0).cast<float>() + Eigen::Vector3f(0.0f, 0.0f, 1e-3f);
  }

  RayScene scene_;
  std::uint32_t ball_ = 0, ground_ = 0;
};

TEST_F(RayScenes, DistanceIsThatOfTheSphere) {
  SeededRandom random;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f direction = Direction(random).normalized();
    const Eigen::Vector3f origin = Eigen::Vector3f(0.0f, 0.0f, 3.0f) - 1.5f * direction;
    const auto hit = scene_.Cast({origin, direction});
    ASSERT_TRUE(hit);
    if (hit->geometry != ball_) continue;
    EXPECT_NEAR(hit->distance, 0.5f, 2e-3f);  // the facets' sagitta
    EXPECT_LT(hit->normal.normalized().dot(direction), -0.99f);
  }
}

TEST_F(RayScenes, GridsAreToldApartAndCoverTheirRectangle) {
  SeededRandom random;
  for (int i = 0; i < 5000; ++i) {
    // Also along the seam and along the cells' edges.
    const double x = i % 3 == 0 ? std::round(random.Uniform(-3.4, 3.4)) : random.Uniform(-4, 4);
    const double y = random.Uniform(-4, 4);
    const Eigen::Vector3f origin(static_cast<float>(x), static_cast<float>(y), 0.5f);
    const auto hit = scene_.Cast({origin, Eigen::Vector3f(0.0f, 0.0f, -1.0f)});
    ASSERT_TRUE(hit) << x << " " << y;
    EXPECT_EQ(hit->geometry, ground_);
    EXPECT_NEAR(hit->distance, 0.5f, 1e-6f);
    if (x != 0.0) {
      EXPECT_EQ(hit->facet, x < 0.0 ? 0u : 1u);
    }
  }
  EXPECT_FALSE(scene_.Cast({{4.01f, 0.0f, 0.5f}, {0.0f, 0.0f, -1.0f}}));
}

TEST_F(RayScenes, EightRaysFindWhatEachFinds) {
  SeededRandom random;
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f origin = random.Vector(3.0).cast<float>();
    RayScene::Directions directions;
    for (auto& direction : directions) direction = Direction(random);
    const auto together = scene_.Cast(origin, directions);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const auto alone = scene_.Cast({origin, directions[k]});
      ASSERT_EQ(alone.has_value(), together[k].has_value());
      if (!alone) continue;
      ++hits;
      EXPECT_NEAR(alone->distance, together[k]->distance, 1e-5f * (1.0f + alone->distance));
      EXPECT_EQ(alone->geometry, together[k]->geometry);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST_F(RayScenes, OnlyWhatIsBetweenFirstAndLastCounts) {
  const Eigen::Vector3f origin(0.0f, 0.0f, 1.0f), up(0.0f, 0.0f, 2.0f);  // the ball from 0.5 to 1.5
  EXPECT_TRUE(scene_.IsOccluded({origin, up}));
  EXPECT_TRUE(scene_.IsOccluded({origin, up, 0.0f, 0.51f}));
  EXPECT_FALSE(scene_.IsOccluded({origin, up, 0.0f, 0.49f}));
  EXPECT_TRUE(scene_.IsOccluded({origin, up, 1.0f}));
  EXPECT_FALSE(scene_.IsOccluded({origin, up, 1.51f}));
  EXPECT_FALSE(scene_.Cast({origin, up, 0.0f, 0.49f}));
  EXPECT_NEAR(scene_.Cast({origin, up})->distance, 0.5f, 1e-3f);
  EXPECT_NEAR(scene_.Cast({origin, up, 1.0f})->distance, 1.5f, 1e-3f);
  EXPECT_FALSE(scene_.IsOccluded({{9.0f, 0.0f, 1.0f}, up}));
}

}  // namespace
}  // namespace rigmap
