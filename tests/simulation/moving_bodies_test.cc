#include "simulation/moving_bodies.h"

#include <gtest/gtest.h>

#include "simulation/rover_motion.h"
#include "tests/simulation/mesh_checks.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// Light is worked out from the facets' sides, so that they must face outwards.
void ExpectSolid(const Body& body, SeededRandom& random) {
  EXPECT_TRUE(IsClosed(body.mesh));
  EXPECT_GT(VolumeOf(body.mesh), 0.0);
  EXPECT_EQ(body.albedo.size(), body.mesh.vertices.size());
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3f origin = 6.0f * random.Vector(1.0).cast<float>().normalized(),
                          aim(0.0f, 0.0f, 0.8f);
    const Eigen::Vector3f direction =
        (aim + random.Vector(0.9).cast<float>() - origin).normalized();
    const auto hit = body.scene.Cast({origin, direction});
    if (!hit) continue;
    ++hits;
    EXPECT_LT(hit->normal.dot(direction), 0.0f);
  }
  EXPECT_GT(hits, 200);
}

TEST(MovingBodies, RoverAndPersonFaceOutwards) {
  SeededRandom random;
  ExpectSolid(*MakeRoverBody(), random);
  for (const double stride : {0.0, 0.25, 0.5, 0.75}) ExpectSolid(*MakePersonBody(stride), random);
}

TEST(MovingBodies, PersonStandsOnTheGround) {
  for (const double stride : {0.0, 0.25, 0.5, 0.75}) {
    float lowest_m = 1e9f, highest_m = -1e9f;
    const auto person = MakePersonBody(stride);
    for (const auto& vertex : person->mesh.vertices) {
      lowest_m = std::min(lowest_m, vertex.z());
      highest_m = std::max(highest_m, vertex.z());
      EXPECT_LT(vertex.head<2>().norm(), 0.6f);
    }
    EXPECT_NEAR(highest_m, 1.75f, 0.01f);
    EXPECT_NEAR(lowest_m, 0.0f, 0.08f);
  }
}

TEST(MovingBodies, RoverLeavesTheCamerasFreeAndShowsAWheelInTheCorner) {
  const StereoRig rig = LocCamRig();
  const auto rover = MakeRoverBody();
  const Rigid3 body_from_left = MountOf(rig).body_from_left;
  SeededRandom random;
  for (const Eye eye : kEyes) {
    const Rigid3 body_from_eye =
        eye == Eye::kLeft ? body_from_left : body_from_left * rig.right_from_left.Inverse();
    const Eigen::Vector3f origin = body_from_eye.translation.cast<float>();
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3f direction = random.Vector(1.0).cast<float>().normalized();
      ASSERT_FALSE(rover->scene.IsOccluded({origin, direction, 0.0f, 0.2f}));
    }
    int seen = 0, seen_elsewhere = 0;
    const Camera& camera = rig.Of(eye).camera;
    for (int u = 2; u < camera.width; u += 8) {
      for (int v = 2; v < camera.height; v += 8) {
        const Eigen::Vector3d ray = Undistort(camera, Eigen::Vector2d(u, v))->homogeneous();
        const bool hit = rover->scene.IsOccluded(
            {origin, (body_from_eye.rotation * ray).normalized().cast<float>()});
        (u < camera.width / 3 && v > camera.height / 2 ? seen : seen_elsewhere) += hit;
      }
    }
    EXPECT_EQ(seen_elsewhere, 0);
    if (eye == Eye::kLeft) {
      EXPECT_GT(seen, 20);
    }
  }
}

}  // namespace
}  // namespace rigmap
