#include "simulation/view_renderer.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "simulation/internal/materials.h"
#include "simulation/internal/pixel_footprint.h"
#include "simulation/internal/ray_image.h"
#include "simulation/internal/world_parts.h"

namespace rigmap {
namespace {

using Colour = Eigen::Vector3f;

// Light of the sun and of the sky on a surface that faces them, so that level sand under a sun of
// 19 degrees comes to about 0.4 times 1.
const Colour kSun(1.95f, 1.82f, 1.60f);
const Colour kSky(0.50f, 0.53f, 0.57f);
constexpr float kSunRayLift_m = 0.003f;  // where rays towards the sun start
constexpr float kSky_m = 1e6f;           // stands for the sky's distance
constexpr std::uint32_t kFirstBody = 0xFFFFFFF0u;

}  // namespace

// One call of Render.
class ViewRenderer::View {
 public:
  View(const ViewRenderer& renderer, const Rigid3& world_from_camera,
       std::span<const PosedBody> bodies)
      : rays_(renderer.rays_),
        columns_(renderer.camera_.width + 2),
        parts_(renderer.world_.parts()),
        sun_(parts_.options.SunDirection().cast<float>()),
        seed_(parts_.material_seed),
        contrast_(static_cast<float>(parts_.options.contrast)),
        rotation_(world_from_camera.rotation.toRotationMatrix().cast<float>()),
        origin_(world_from_camera.translation.cast<float>()),
        bodies_(bodies) {
    for (const PosedBody& body : bodies) {
      const Rigid3 body_from_world = body.world_from_body.Inverse();
      turns_.push_back(body_from_world.rotation.toRotationMatrix().cast<float>());
      shifts_.push_back(body_from_world.translation.cast<float>());
    }
  }

  // At a place in the image, in pixels.
  RaySample At(float column, float row) const {
    const int x = static_cast<int>(std::floor(column)), y = static_cast<int>(std::floor(row));
    const Eigen::Vector3f direction = rotation_ * RayAt(column, row);
    return SampleAlong(direction, parts_.scene.Cast({origin_, direction}), StepsAt(x, y));
  }

  // Of a pixel and all around it, by single rays.
  Colour Around(int column, int row) const {
    const float turn = (row + column) % 2 == 0 ? 1.0f : -1.0f;  // by half, at every other pixel
    const auto x = static_cast<float>(column), y = static_cast<float>(row);
    Colour sum = Colour::Zero();
    for (const auto& [right, down] : kRaysAround) {
      sum += kRayShare * At(x + turn * right, y + turn * down).colour;
    }
    return sum;
  }

  // A row of rays, 0.25 px before or behind a row of pixels.
  void Row(float row, std::span<RaySample> samples) const {
    const int above = static_cast<int>(std::floor(row));
    const int width = static_cast<int>(samples.size());
    for (int first = 0; first < width; first += 8) {
      RayScene::Directions directions;
      for (int i = 0; i < 8; ++i) {
        directions[i] = rotation_ * RayAt(static_cast<float>(std::min(first + i, width - 1)), row);
      }
      const auto hits = parts_.scene.Cast(origin_, directions);
      for (int i = 0; i < std::min(8, width - first); ++i) {
        samples[first + i] = SampleAlong(directions[i], hits[i], StepsAt(first + i, above));
      }
    }
  }

 private:
  const Eigen::Vector3f& RayOf(int column, int row) const {
    return rays_[static_cast<std::size_t>(row + 1) * columns_ + column + 1];
  }
  Eigen::Vector3f RayAt(float column, float row) const {
    const float x = std::floor(column), y = std::floor(row), u = column - x, v = row - y;
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    if (u == 0.0f && v == 0.0f) return RayOf(ix, iy);
    return ((1.0f - v) * ((1.0f - u) * RayOf(ix, iy) + u * RayOf(ix + 1, iy)) +
            v * ((1.0f - u) * RayOf(ix, iy + 1) + u * RayOf(ix + 1, iy + 1)))
        .normalized();
  }

  // Of what a ray stands for, to the right and down.
  RaySteps StepsAt(int column, int row) const {
    const Eigen::Vector3f& here = RayOf(column, row);
    return {RayImage::kRayWidth_px * (rotation_ * (RayOf(column + 1, row) - here)),
            RayImage::kRayHeight_px * (rotation_ * (RayOf(column, row + 1) - here))};
  }

  Ray InBody(std::size_t i, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    return {turns_[i] * origin + shifts_[i], turns_[i] * direction};
  }

  bool BodiesShade(const Eigen::Vector3f& position) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].body->scene.IsOccluded(InBody(i, position, sun_))) return true;
    }
    return false;
  }

  RaySample SampleAlong(const Eigen::Vector3f& direction, const std::optional<RayHit>& hit,
                        const RaySteps& steps) const {
    float distance_m = hit ? hit->distance : kSky_m;
    std::optional<RaySample> body;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Ray ray = InBody(i, origin_, direction);
      ray.last = distance_m;
      if (const auto body_hit = bodies_[i].body->scene.Cast(ray)) {
        distance_m = body_hit->distance;
        body = OnBody(i, *body_hit);
      }
    }
    if (body) return *body;
    if (!hit) return {SkyRadiance(direction, sun_, seed_), 0.0f, RaySample::kNoThing};
    Eigen::Vector3f normal = hit->normal.normalized();
    if (normal.dot(direction) > 0.0f) normal = -normal;
    const Eigen::Vector3f position = origin_ + distance_m * direction;
    const bool is_sand = hit->geometry == parts_.sand_geometry;
    // The mean slope is what a pixel of sand covers; single facets would make it flicker.
    const PixelFootprint cover = FootprintOn(
        direction, steps, is_sand ? Eigen::Vector3f::UnitZ().eval() : normal, distance_m);
    const Colour lit = is_sand ? OnSand(*hit, position, cover) : OnSolid(*hit, position, cover);
    return {InHaze(lit, distance_m), 1.0f / distance_m, ThingAt(*hit)};
  }

  std::uint32_t ThingAt(const RayHit& hit) const {
    if (hit.geometry == parts_.sand_geometry) return hit.geometry;
    const LitMesh& solid = *parts_.SolidOf(hit.geometry);
    return hit.geometry + 16u * (1u + solid.piece[solid.mesh.triangles[hit.facet][0]]);
  }

  static Colour InHaze(const Colour& colour, float distance_m) {
    const float haze = 1.0f - std::exp(-distance_m / 2500.0f);
    return colour + haze * (Colour(0.92f, 0.93f, 0.94f) - colour);
  }

  Colour Lit(const Appearance& appearance, Light light, const Eigen::Vector3f& position) const {
    if (!bodies_.empty() && light.visible > 0.0f &&
        BodiesShade(position + Eigen::Vector3f(0.0f, 0.0f, kSunRayLift_m))) {
      light.sun = light.visible = 0.0f;
    }
    // Small relief tilts the surface; it faces the sky a little less on the whole.
    const float tilt = -appearance.slope.dot(sun_.head<2>());
    const float sun = std::max(0.0f, light.sun + light.visible * tilt);
    const float sky = light.sky * (1.0f - 0.15f * std::min(1.0f, appearance.slope.squaredNorm()));
    return appearance.albedo.cwiseProduct(sun * kSun + sky * kSky);
  }

  Colour OnSand(const RayHit& hit, const Eigen::Vector3f& position,
                const PixelFootprint& cover) const {
    const int samples = cover.Samples();
    const float extent_m = std::max(cover.across_m, cover.along_m / static_cast<float>(samples));
    const bool is_dune = position.x() > parts_.options.terrain.hinterland_m;
    Colour sum = Colour::Zero();
    for (int i = 0; i < samples; ++i) {
      const float share = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples) - 0.5f;
      const Eigen::Vector3f at = position + share * cover.along;
      const Eigen::Vector2d flat = at.head<2>().cast<double>();
      const SandState sand = parts_.sand->At(hit.facet, flat, extent_m);
      sum += Lit(is_dune ? DuneAppearance(flat, extent_m, seed_)
                         : SandAppearance(flat, extent_m, sand.tone, contrast_, seed_),
                 sand.light, at);
    }
    return sum / static_cast<float>(samples);
  }

  Colour OnSolid(const RayHit& hit, const Eigen::Vector3f& position,
                 const PixelFootprint& cover) const {
    const LitMesh& solid = *parts_.SolidOf(hit.geometry);
    const auto& [a, b, c] = solid.mesh.triangles[hit.facet];
    const float u = hit.u, v = hit.v, w = 1.0f - u - v;
    const Light &la = solid.light[a], &lb = solid.light[b], &lc = solid.light[c];
    const Light light{w * la.sun + u * lb.sun + v * lc.sun,
                      w * la.visible + u * lb.visible + v * lc.visible,
                      w * la.sky + u * lb.sky + v * lc.sky};
    const float extent_m = std::max(cover.across_m, cover.along_m / 2.0f);
    Appearance appearance{solid.albedo[a]};
    if (solid.kind == SurfaceKind::kSea) {
      appearance = SeaAppearance(position.head<2>().cast<double>(), extent_m, seed_);
    } else if (solid.kind == SurfaceKind::kRock) {
      appearance.albedo *= RockTone(position.cast<double>(), extent_m, contrast_, seed_ + 5);
    }
    return Lit(appearance, light, position);
  }

  RaySample OnBody(std::size_t i, const RayHit& hit) const {
    const Body& body = *bodies_[i].body;
    const Eigen::Vector3f normal = (turns_[i].transpose() * hit.normal).normalized();
    const Colour light =
        std::max(0.0f, normal.dot(sun_)) * kSun + 0.5f * (1.0f + normal.z()) * kSky;
    const Colour colour = body.albedo[body.mesh.triangles[hit.facet][0]].cwiseProduct(light);
    return {colour, 1.0f / std::max(hit.distance, 1e-3f),
            kFirstBody + static_cast<std::uint32_t>(i % 8)};
  }

  const std::vector<Eigen::Vector3f>& rays_;
  int columns_;
  const World::Parts& parts_;
  Eigen::Vector3f sun_;
  std::uint32_t seed_;
  float contrast_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f origin_;
  std::span<const PosedBody> bodies_;
  std::vector<Eigen::Matrix3f> turns_;  // body_from_world, in single precision
  std::vector<Eigen::Vector3f> shifts_;
};

ViewRenderer::ViewRenderer(const World& world, const Camera& camera)
    : world_(world), camera_(camera) {
  rays_.reserve(static_cast<std::size_t>(camera.width + 2) * (camera.height + 2));
  for (int row = -1; row <= camera.height; ++row) {
    for (int column = -1; column <= camera.width; ++column) {
      const auto ray = Undistort(camera, Eigen::Vector2d(column, row));
      if (!ray) {
        throw DataError(
            fmt::format("camera: expected a distortion that can be undone in all of {} x "
                        "{} pixels, found that it cannot at ({}, {})",
                        camera.width, camera.height, column, row));
      }
      rays_.push_back(ray->homogeneous().normalized().cast<float>());
    }
  }
}

cv::Mat ViewRenderer::Render(const Rigid3& world_from_camera,
                             std::span<const PosedBody> bodies) const {
  const View view(*this, world_from_camera, bodies);
  RayImage rays({camera_.width, camera_.height});
  for (int i = 0; i < rays.RayRows(); ++i) view.Row(RayImage::RowOf(i), rays.Row(i));
  cv::Mat image(camera_.height, camera_.width, CV_32FC3);
  for (int row = 0; row < image.rows; ++row) {
    auto* pixels = image.ptr<cv::Vec3f>(row);
    for (int column = 0; column < image.cols; ++column) {
      const Colour colour =
          rays.IsAtEdge(column, row) ? view.Around(column, row) : rays.ThroughLens(column, row);
      pixels[column] = cv::Vec3f(colour.x(), colour.y(), colour.z());
    }
  }
  return image;
}

}  // namespace rigmap
