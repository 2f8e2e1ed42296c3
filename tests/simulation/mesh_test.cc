#include "simulation/mesh.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/simulation/mesh_checks.h"

namespace rigmap {
namespace {

TEST(Mesh, IcosphereIsClosedRoundAndFacesOutwards) {
  for (int subdivisions = 0; subdivisions <= 4; ++subdivisions) {
    const Mesh sphere = Icosphere(subdivisions);
    const std::size_t quarters = std::size_t{1} << (2 * subdivisions);
    EXPECT_EQ(sphere.triangles.size(), 20 * quarters);
    EXPECT_EQ(sphere.vertices.size(), 10 * quarters + 2);
    EXPECT_TRUE(IsClosed(sphere));
    for (const auto& vertex : sphere.vertices) EXPECT_NEAR(vertex.norm(), 1.0f, 1e-6f);
    for (const auto& [a, b, c] : sphere.triangles) {
      const auto& v = sphere.vertices;
      EXPECT_GT((v[b] - v[a]).cross(v[c] - v[a]).dot(v[a] + v[b] + v[c]), 0.0f);
    }
  }
  EXPECT_NEAR(VolumeOf(Icosphere(4)), 4.0 / 3.0 * std::numbers::pi, 0.02);
}

TEST(Mesh, ChecksSeeAHoleAndATriangleThatIsTurned) {
  Mesh open = Icosphere(1), turned = Icosphere(1);
  open.triangles.pop_back();
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_FALSE(IsClosed(open));
  EXPECT_FALSE(IsClosed(turned));
}

TEST(Mesh, NormalsOfTheSphereAreItsPositions) {
  const Mesh sphere = Icosphere(3);
  const auto normals = sphere.VertexNormals();
  ASSERT_EQ(normals.size(), sphere.vertices.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), 1.0f, 1e-5f);
    EXPECT_GT(normals[i].dot(sphere.vertices[i]), 0.9995f);
  }
}

TEST(Mesh, AppendKeepsBothParts) {
  Mesh both = Icosphere(0);
  both.albedo.setConstant(0.25f);
  Mesh moved = Icosphere(1);
  for (auto& vertex : moved.vertices) vertex.x() += 5.0f;
  both.Append(moved);
  EXPECT_EQ(both.vertices.size(), 12u + 42u);
  EXPECT_EQ(both.triangles.size(), 20u + 80u);
  EXPECT_TRUE(IsClosed(both));
  EXPECT_NEAR(VolumeOf(both), VolumeOf(Icosphere(0)) + VolumeOf(moved), 1e-4);
  EXPECT_EQ(both.albedo, Eigen::Vector3f::Constant(0.25f));
}

}  // namespace
}  // namespace rigmap
