#include "simulation/moving_bodies.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

using Vector = Eigen::Vector3f;

// Collects coloured parts of a body.
class BodyBuilder {
 public:
  // An ellipsoid about a place, turned about the y axis.
  void AddEllipsoid(const Vector& centre, const Vector& half_extent, const Vector& albedo,
                    float pitch_rad = 0.0f) {
    Mesh part = Icosphere(3);
    const Eigen::AngleAxisf turn(pitch_rad, Vector::UnitY());
    for (auto& vertex : part.vertices) vertex = turn * vertex.cwiseProduct(half_extent) + centre;
    Add(part, albedo);
  }

  void AddBox(const Vector& low, const Vector& high, const Vector& albedo) {
    Mesh part;
    for (int i = 0; i < 8; ++i) {
      part.vertices.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                                 (i & 4) ? high.z() : low.z());
    }
    part.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    Add(part, albedo);
  }

  // A wheel that stands on the ground, its axle along y.
  void AddWheel(const Vector& hub, float radius, float width) {
    constexpr std::uint32_t kSpokes = 40;
    Mesh part;
    for (std::uint32_t i = 0; i < kSpokes; ++i) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kSpokes;
      const float tread = radius * (i % 2 ? 1.0f : 0.93f);
      const Vector rim(tread * std::cos(angle), 0.0f, tread * std::sin(angle));
      for (const float side : {-0.5f, 0.5f}) {
        part.vertices.push_back(hub + rim + Vector(0.0f, side * width, 0.0f));
      }
      const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSpokes), middle = 2 * kSpokes;
      part.triangles.insert(
          part.triangles.end(),
          {{a, a + 1, b + 1}, {a, b + 1, b}, {middle, a, b}, {middle + 1, b + 1, a + 1}});
    }
    for (const float side : {-0.5f, 0.5f}) {
      part.vertices.push_back(hub + Vector(0.0f, side * width, 0.0f));
    }
    Add(part, Vector::Constant(0.06f));
  }

  std::unique_ptr<Body> Finish() {
    body_->scene.AddMesh(body_->mesh);
    body_->scene.Commit();
    return std::move(body_);
  }

 private:
  void Add(const Mesh& part, const Vector& albedo) {
    body_->mesh.Append(part);
    body_->albedo.resize(body_->mesh.vertices.size(), albedo);
  }

  std::unique_ptr<Body> body_ = std::make_unique<Body>();
};

}  // namespace

std::unique_ptr<Body> MakeRoverBody() {
  const Vector metal = Vector::Constant(0.45f), dark = Vector::Constant(0.12f);
  BodyBuilder builder;
  builder.AddBox({-0.55f, -0.28f, 0.32f}, {0.35f, 0.28f, 0.62f}, metal);  // deck
  builder.AddBox({0.02f, -0.05f, 0.62f}, {0.10f, 0.05f, 1.30f}, metal);   // mast
  builder.AddBox({-0.02f, -0.22f, 1.30f}, {0.12f, 0.22f, 1.42f}, dark);   // its head
  builder.AddBox({-0.26f, 0.02f, 0.62f}, {-0.20f, 0.07f, 2.10f}, dark);   // the antenna's pole
  for (const float x : {-0.60f, 0.0f, 0.60f}) {
    for (const float y : {-0.37f, 0.37f}) builder.AddWheel({x, y, 0.123f}, 0.123f, 0.15f);
  }
  builder.AddBox({0.5f, 0.80f, 0.16f}, {1.62f, 0.84f, 0.20f}, dark);  // the arm
  builder.AddWheel({1.62f, 0.72f, 0.17f}, 0.17f, 0.16f);
  return builder.Finish();
}

std::unique_ptr<Body> MakePersonBody(double stride) {
  const Vector skin(0.45f, 0.30f, 0.22f), coat(0.10f, 0.12f, 0.22f), trousers(0.06f, 0.06f, 0.07f);
  const auto swing = static_cast<float>(0.42 * std::sin(2.0 * std::numbers::pi * stride));
  BodyBuilder builder;
  builder.AddEllipsoid({0.0f, 0.0f, 1.63f}, {0.10f, 0.08f, 0.12f}, skin);
  builder.AddEllipsoid({0.0f, 0.0f, 1.17f}, {0.13f, 0.22f, 0.36f}, coat);
  for (const float side : {-1.0f, 1.0f}) {
    const float angle = side * swing, hip_m = 0.88f, half_leg_m = 0.45f;
    builder.AddEllipsoid(
        {-half_leg_m * std::sin(angle), 0.10f * side, hip_m - half_leg_m * std::cos(angle)},
        {0.08f, 0.08f, half_leg_m}, trousers, angle);
    builder.AddEllipsoid({0.3f * std::sin(angle), 0.27f * side, 1.12f}, {0.05f, 0.05f, 0.32f}, coat,
                         -0.8f * angle);
  }
  return builder.Finish();
}

}  // namespace rigmap
