#include "simulation/view_renderer.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "simulation/scaled_rig.h"
#include "tests/simulation/small_world.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

const Camera& SmallCamera() {
  static const Camera camera = Scaled(LocCamRig().left.camera, 0.25);
  return camera;
}
const ViewRenderer& Renderer() {
  static const ViewRenderer renderer(SmallWorld(), SmallCamera());
  return renderer;
}

bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}
cv::Vec3f At(const cv::Mat& image, int u, int v) { return image.at<cv::Vec3f>(v, u); }
float Sum(const cv::Vec3f& colour) { return colour[0] + colour[1] + colour[2]; }

// Through the middle of a pixel, in the world, unit.
Eigen::Vector3d RayOf(const Rigid3& world_from_camera, int u, int v) {
  return world_from_camera.rotation *
         Undistort(SmallCamera(), Eigen::Vector2d(u, v))->homogeneous().normalized();
}
std::optional<SurfaceHit> HitOf(const Rigid3& world_from_camera, int u, int v) {
  return SmallWorld().Cast(world_from_camera.translation, RayOf(world_from_camera, u, v));
}

// Meets a placed body?
std::optional<RayHit> HitOn(const PosedBody& body, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction) {
  const Rigid3 body_from_world = body.world_from_body.Inverse();
  return body.body->scene.Cast({(body_from_world * origin).cast<float>(),
                                (body_from_world.rotation * direction).cast<float>()});
}

// Whose light a pixel may show: rows of rays up to 1.25 px before and behind mix, and at edges
// single rays all around.
constexpr std::array<std::array<int, 2>, 11> kSpot{{{0, 0},
                                                    {1, 0},
                                                    {-1, 0},
                                                    {0, 1},
                                                    {0, -1},
                                                    {1, 1},
                                                    {-1, 1},
                                                    {1, -1},
                                                    {-1, -1},
                                                    {0, 2},
                                                    {0, -2}}};

Rigid3 OnTheSand(double x_m, double y_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, SmallWorld().terrain().Height(x_m, y_m)}};
}

// A wall across the view, in its own axes: `half_width_m` to both sides of x = z = 0.
std::unique_ptr<Body> Wall(double half_width_m, float albedo) {
  auto wall = std::make_unique<Body>();
  const auto half = static_cast<float>(half_width_m);
  wall->mesh.vertices = {
      {-half, -1.0f, 0.0f}, {half, -1.0f, 0.0f}, {half, 1.0f, 0.0f}, {-half, 1.0f, 0.0f}};
  wall->mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall->albedo.assign(4, Eigen::Vector3f::Constant(albedo));
  wall->scene.AddMesh(wall->mesh);
  wall->scene.Commit();
  return wall;
}

TEST(ViewRenderer, EqualViewsGiveEqualBytesOnAnyThread) {
  const auto drive = SmallDrive();
  std::array<cv::Mat, 6> images;
  tbb::parallel_for(std::size_t{0}, images.size(),
                    [&](std::size_t i) { images[i] = Renderer().Render(drive[i / 2]); });
  for (std::size_t i = 0; i < images.size(); ++i) {
    ASSERT_EQ(images[i].type(), CV_32FC3);
    EXPECT_EQ(images[i].size(), cv::Size(SmallCamera().width, SmallCamera().height));
    EXPECT_TRUE(AreEqual(images[i], Renderer().Render(drive[i / 2])));
    if (i % 2) {
      EXPECT_TRUE(AreEqual(images[i], images[i - 1]));
      EXPECT_FALSE(AreEqual(images[i], images[(i + 1) % images.size()]));
    }
  }
}

TEST(ViewRenderer, RadianceIsFiniteAndSandIsAboutAsBrightAsStated) {
  const Rigid3 pose = SmallDrive().front();
  const cv::Mat image = Renderer().Render(pose);
  std::vector<float> sand;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec3f colour = At(image, u, v);
      for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(std::isfinite(colour[i]));
        ASSERT_GE(colour[i], 0.0f);
        ASSERT_LT(colour[i], 3.0f);
      }
      const auto hit = HitOf(pose, u, v);
      if (hit && hit->kind == SurfaceKind::kSand) sand.push_back(colour[0]);
    }
  }
  ASSERT_GT(sand.size(), 5000u);
  std::ranges::nth_element(sand, sand.begin() + std::ssize(sand) / 2);
  EXPECT_NEAR(sand[sand.size() / 2], 0.4f, 0.15f);
}

TEST(ViewRenderer, SkyIsAboveTheHorizonAndInfinitelyFar) {
  const auto drive = SmallDrive();
  const Rigid3 here = drive.front(), there{here.rotation, drive.back().translation};
  const cv::Mat a = Renderer().Render(here), b = Renderer().Render(there);
  int sky = 0, bright = 0;
  for (int v = 2; v < a.rows - 2; ++v) {
    for (int u = 1; u < a.cols - 1; ++u) {
      const double up = RayOf(here, u, v).z();
      const auto no_hit = [&](const Rigid3& pose) {
        return std::ranges::none_of(
            kSpot, [&](const auto& by) { return HitOf(pose, u + by[0], v + by[1]).has_value(); });
      };
      if (up < -0.02) {
        EXPECT_TRUE(HitOf(here, u, v)) << u << " " << v;
      } else if (no_hit(here) && no_hit(there)) {
        ++sky;
        EXPECT_EQ(At(a, u, v), At(b, u, v)) << u << " " << v;
        bright += At(a, u, v)[2] > 0.5f;
      }
    }
  }
  EXPECT_GT(sky, 300);
  EXPECT_EQ(bright, sky);
}

TEST(ViewRenderer, BodyHidesWhatIsBehindAndShadesTheGround) {
  const Rigid3 pose = SmallDrive().front();
  const auto person = MakePersonBody(0.25);
  const PosedBody posed{person.get(), OnTheSand(3.2, 0.6)};
  const cv::Mat without = Renderer().Render(pose), with = Renderer().Render(pose, {{posed}});
  const Eigen::Vector3d sun = SmallWorld().options().SunDirection();
  int hidden = 0, shaded = 0, unchanged = 0;
  for (int v = 2; v < without.rows - 2; ++v) {
    for (int u = 1; u < without.cols - 1; ++u) {
      const auto covers = [&](int x, int y) {
        const auto on_body = HitOn(posed, pose.translation, RayOf(pose, x, y));
        const auto behind = HitOf(pose, x, y);
        return on_body && (!behind || behind->distance_m > on_body->distance);
      };
      const bool covered = covers(u, v);
      const bool is_outline = std::ranges::any_of(
          kSpot, [&](const auto& by) { return covers(u + by[0], v + by[1]) != covered; });
      if (is_outline) continue;
      const auto hit = HitOf(pose, u, v);
      const float change = Sum(At(with, u, v)) - Sum(At(without, u, v));
      if (covered) {
        ++hidden;
        EXPECT_NE(change, 0.0f);
      } else if (!hit) {
        EXPECT_EQ(change, 0.0f);
      } else if (HitOn(posed, hit->position, sun)) {
        EXPECT_LE(change, 1e-6f);
        shaded += change < -0.1f;
      } else {
        unchanged += change == 0.0f;
      }
    }
  }
  EXPECT_GT(hidden, 400);
  EXPECT_GT(shaded, 30);
  EXPECT_GT(unchanged, without.rows * without.cols / 2);
}

TEST(ViewRenderer, BodyBehindSomethingIsHidden) {
  const Rigid3 pose = SmallDrive().front();
  const auto wall = Wall(20.0, 0.5f);
  Rigid3 under_ground = pose;
  under_ground.translation += pose.rotation * Eigen::Vector3d(0.0, 0.0, 3.0);
  const cv::Mat with = Renderer().Render(pose, {{{wall.get(), under_ground}}});
  const cv::Mat without = Renderer().Render(pose);
  int nearer = 0, farther = 0;
  // By how much the ground is nearer, m.
  const auto gap_m = [&](int u, int v) {
    const auto hit = HitOf(pose, u, v);
    const auto on_wall = HitOn({wall.get(), under_ground}, pose.translation, RayOf(pose, u, v));
    return hit && on_wall ? on_wall->distance - hit->distance_m : 0.0;
  };
  for (int v = 3; v < with.rows - 2; v += 3) {
    for (int u = 3; u < with.cols - 1; u += 3) {
      const bool is_nearer = std::ranges::all_of(
          kSpot, [&](const auto& by) { return gap_m(u + by[0], v + by[1]) > 0.05; });
      if (is_nearer) {
        ++nearer;
        EXPECT_LE(Sum(At(with, u, v)), Sum(At(without, u, v)) + 1e-5f);  // at most in its shadow
      } else if (gap_m(u, v) < -0.05) {
        farther += At(with, u, v) != At(without, u, v);
      }
    }
  }
  EXPECT_GT(nearer, 20);
  EXPECT_GT(farther, 20);
}

TEST(ViewRenderer, NearerBodyHidesTheOtherInAnyOrder) {
  const Rigid3 pose = SmallDrive().front();
  const auto dark = Wall(0.5, 0.0f), bright = Wall(0.5, 0.9f);
  const auto ahead = [&](double distance_m) {
    return Rigid3{pose.rotation,
                  pose.translation + pose.rotation * Eigen::Vector3d(0.0, 0.0, distance_m)};
  };
  const PosedBody near{dark.get(), ahead(1.0)}, far{bright.get(), ahead(1.5)};
  const int u = SmallCamera().width / 2, v = SmallCamera().height / 2;
  const cv::Mat one = Renderer().Render(pose, {{near, far}}),
                other = Renderer().Render(pose, {{far, near}});
  EXPECT_EQ(At(one, u, v), cv::Vec3f(0.0f, 0.0f, 0.0f));
  EXPECT_EQ(At(other, u, v), cv::Vec3f(0.0f, 0.0f, 0.0f));
}

// The slanting right edge of a black wall before the sky: what it covers of each row, added up,
// tells where the edge is.
TEST(ViewRenderer, EdgesAreSmoothAndWhereTheLensPutsThem) {
  Rigid3 pose = SmallDrive().front();
  pose.rotation = pose.rotation * Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX());  // up
  const auto wall = Wall(0.05, 0.0f);
  const Rigid3 camera_from_wall{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ())), {0.0, 0.0, 1.0}};
  const PosedBody posed{wall.get(), pose * camera_from_wall};
  const cv::Mat with = Renderer().Render(pose, {{posed}}), without = Renderer().Render(pose);
  double sum_px = 0.0, most_px = 0.0;
  int rows = 0, between = 0;
  for (int v = 60; v < 130; ++v) {
    double covered_px = 0.0;
    for (int u = 0; u < with.cols; ++u) {
      const double share = 1.0 - Sum(At(with, u, v)) / Sum(At(without, u, v));
      between += share > 0.1 && share < 0.9;
      covered_px += share;
    }
    // Where both edges cross the row's middle, by bisection along the wall.
    std::array<double, 2> edge_px{};
    for (int side = 0; side < 2; ++side) {
      double low = -1.0, high = 1.0;
      Eigen::Vector2d pixel;
      for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        pixel = *Project(SmallCamera(),
                         camera_from_wall * Eigen::Vector3d(side ? 0.05 : -0.05, middle, 0));
        (pixel.y() < v ? low : high) = middle;
      }
      edge_px[side] = pixel.x();
    }
    const double error_px = covered_px - (edge_px[1] - edge_px[0]);
    sum_px += error_px;
    most_px = std::max(most_px, std::abs(error_px));
    ++rows;
  }
  EXPECT_NEAR(sum_px / rows, 0.0, 0.03);
  EXPECT_LT(most_px, 0.3);  // a quarter of a pixel is what eight rays tell
  EXPECT_GT(between, rows);
}

TEST(ViewRenderer, ContrastOfTheSandFollowsItsOption) {
  const std::vector<Eigen::Vector2d> outline{{0.0, 0.0}, {0.4, 0.0}};
  Rigid3 pose = RoverPose(0.0, 0.0, 0.0);
  pose.translation.z() = 1.1;
  double last = 0.0;
  for (const double contrast : {0.25, 0.5, 1.0, 1.5}) {
    SceneOptions scene = MakeScene("flat-sand", 3);
    scene.sand_cell_m = 0.1;
    scene.contrast = contrast;
    const World world(scene, outline);
    const cv::Mat image = ViewRenderer(world, SmallCamera()).Render(pose);
    cv::Scalar mean, sigma;
    cv::meanStdDev(image(cv::Rect(100, 130, 60, 40)), mean, sigma);
    EXPECT_GT(sigma[1] / mean[1], 1.2 * last) << contrast;
    EXPECT_LT(sigma[1] / mean[1], 0.6);
    last = sigma[1] / mean[1];
  }
}

TEST(ViewRenderer, RefusesALensThatFoldsBack) {
  Camera camera = SmallCamera();
  camera.k1 = -3.0;
  camera.k2 = 0.0;
  EXPECT_THROW(ViewRenderer(SmallWorld(), camera), DataError);
}

}  // namespace
}  // namespace rigmap
