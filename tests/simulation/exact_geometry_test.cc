// Whether pictures show things exactly where the cameras' models say: by discs whose places are
// known, and by what both eyes see of the sand.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "geometry/rectification.h"
#include "geometry/triangulation.h"
#include "imaging/rectifier.h"
#include "simulation/camera_response.h"
#include "simulation/internal/truth_depth.h"
#include "simulation/scaled_rig.h"
#include "simulation/view_renderer.h"
#include "tests/simulation/small_world.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kTolerance_px = 0.1;
constexpr double kRing = 2.5;  // outer radius of a marker's dark ring over that of its disc

const World& MarkedWorld() {
  static const World world = [] {
    SceneOptions scene = MakeScene("flat-sand", 8);
    scene.sand_cell_m = 0.1;
    scene.markers = 60;
    return World(scene, SmallOutline());
  }();
  return world;
}

Rigid3 FromEye(const StereoRig& rig, Eye eye) {
  return eye == Eye::kLeft ? Rigid3{} : rig.right_from_left.Inverse();
}

// The outline of a circle about a marker as an eye sees it; nothing unless all of it is in view.
std::optional<std::vector<Eigen::Vector2d>> OutlineOf(const Camera& camera,
                                                      const Rigid3& camera_from_world,
                                                      const Eigen::Vector3d& centre,
                                                      double radius_m) {
  constexpr int kCorners = 48;
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * EIGEN_PI * i / kCorners;
    const auto pixel = Project(
        camera, camera_from_world *
                    (centre + radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)));
    if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
    outline.push_back(*pixel);
  }
  return outline;
}

Eigen::Vector2d CentroidOf(const std::vector<Eigen::Vector2d>& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0.0;
  const Eigen::Vector2d& origin = polygon.front();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin, b = polygon[i + 1] - origin;
    const double twice = a.x() * b.y() - a.y() * b.x();
    area += twice;
    sum += twice * (a + b) / 3.0;
  }
  return origin + sum / area;
}

// Of the white of a marker's disc, among the pixels that show the disc or the ring close to it:
// weights are shares of white.
Eigen::Vector2d WhiteCentroid(const cv::Mat& image, const Camera& camera,
                              const Rigid3& world_from_eye, const Eigen::Vector3d& centre) {
  constexpr double kReach_m = 1.8 * World::kMarkerRadius_m;
  const auto is_near = [&](int u, int v) {
    const Eigen::Vector3d ray =
        world_from_eye.rotation * Undistort(camera, Eigen::Vector2d(u, v))->homogeneous();
    const Eigen::Vector3d& eye = world_from_eye.translation;
    return (eye + (centre.z() - eye.z()) / ray.z() * ray - centre).norm() < kReach_m;
  };
  const Eigen::Vector2d middle = *Project(camera, world_from_eye.Inverse() * centre);
  std::vector<Eigen::Vector3d> levels;  // u, v, grey
  const int reach_px = static_cast<int>(camera.fx * kReach_m / 0.8);
  for (int v = std::max(0, static_cast<int>(middle.y()) - reach_px);
       v < std::min(camera.height, static_cast<int>(middle.y()) + reach_px); ++v) {
    for (int u = std::max(0, static_cast<int>(middle.x()) - reach_px);
         u < std::min(camera.width, static_cast<int>(middle.x()) + reach_px); ++u) {
      if (is_near(u, v)) levels.emplace_back(u, v, image.at<cv::Vec3f>(v, u)[1]);
    }
  }
  const double dark = std::ranges::min(levels, {}, [](const auto& level) { return level.z(); }).z();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (const auto& level : levels) sums += (level.z() - dark) * level.head<2>().homogeneous();
  return sums.hnormalized();
}

bool IsLargeEnough(const std::vector<Eigen::Vector2d>& disc) {
  Eigen::AlignedBox2d box;
  for (const auto& corner : disc) box.extend(corner);
  return box.sizes().minCoeff() > 6.0;  // px
}

// A marker as seen in one frame.
struct Sighting {
  std::size_t marker = 0;
  std::array<Eigen::Vector2d, 2> seen_px, expected_px;  // left, right
};

bool StandsAlone(std::size_t marker) {
  const auto& markers = MarkedWorld().markers();
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const double gap_m = (markers[i] - markers[marker]).norm();
    if (i != marker && gap_m < 2.0 * kRing * World::kMarkerRadius_m + 0.01) return false;
  }
  return true;
}

std::vector<Sighting> SightingsIn(const StereoRig& rig, const Rigid3& world_from_left) {
  std::array<cv::Mat, 2> images;
  std::array<Rigid3, 2> world_from_eye;
  tbb::parallel_for(0, 2, [&](int i) {
    world_from_eye[i] = world_from_left * FromEye(rig, kEyes[i]);
    images[i] = ViewRenderer(MarkedWorld(), rig.Of(kEyes[i]).camera).Render(world_from_eye[i]);
  });
  std::vector<Sighting> sightings;
  for (std::size_t marker = 0; marker < MarkedWorld().markers().size(); ++marker) {
    if (!StandsAlone(marker)) continue;
    Sighting sighting{.marker = marker};
    bool is_seen = true;
    const Eigen::Vector3d& centre = MarkedWorld().markers()[marker];
    for (std::size_t i = 0; i < 2 && is_seen; ++i) {
      const Camera& camera = rig.Of(kEyes[i]).camera;
      const auto outline = [&](double radius_m) {
        return OutlineOf(camera, world_from_eye[i].Inverse(), centre, radius_m);
      };
      const auto disc = outline(World::kMarkerRadius_m);
      is_seen = disc && outline(kRing * World::kMarkerRadius_m) && IsLargeEnough(*disc);
      if (!is_seen) break;
      sighting.expected_px[i] = CentroidOf(*disc);
      sighting.seen_px[i] = WhiteCentroid(images[i], camera, world_from_eye[i], centre);
    }
    if (is_seen) sightings.push_back(sighting);
  }
  return sightings;
}

void ExpectExact(const StereoRig& rig, const Rigid3& world_from_left, int at_least) {
  const auto sightings = SightingsIn(rig, world_from_left);
  EXPECT_GE(std::ssize(sightings), at_least);
  Eigen::Vector2d sum_px = Eigen::Vector2d::Zero();
  for (const Sighting& sighting : sightings) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector2d error_px = sighting.seen_px[i] - sighting.expected_px[i];
      EXPECT_LT(error_px.norm(), kTolerance_px)
          << "marker " << sighting.marker << " in eye " << i << ": " << error_px.transpose();
      sum_px += error_px;
    }
  }
  EXPECT_LT(sum_px.norm() / (2.0 * static_cast<double>(sightings.size())), 0.03);
}

std::vector<Rigid3> Poses() {
  std::vector<Rigid3> poses;
  for (const double heading_rad : {0.0, 0.9, -1.1, 2.6}) {
    Rigid3 pose = RoverPose(0.6, 0.1, heading_rad);
    pose.translation.z() = 1.1;
    poses.push_back(pose);
  }
  return poses;
}

TEST(ExactGeometry, DiscsAreWhereBothEyesModelsPutThem) {
  const StereoRig rig = Scaled(LocCamRig(), 0.5);
  for (const Rigid3& pose : Poses()) ExpectExact(rig, pose, 3);
}

TEST(ExactGeometry, DiscsAreExactInFullSize) { ExpectExact(LocCamRig(), Poses().front(), 5); }

TEST(ExactGeometry, RectifiedRowsOfDiscsAgree) {
  const StereoRig rig = Scaled(LocCamRig(), 0.5);
  const RectifiedAxes axes = Rectify(rig.right_from_left);
  int checked = 0;
  for (const Rigid3& pose : Poses()) {
    for (const Sighting& sighting : SightingsIn(rig, pose)) {
      const auto left = Turn(axes.rectified_from_left,
                             *Undistort(rig.left.camera, sighting.seen_px[0])),
                 right = Turn(axes.rectified_from_right,
                              *Undistort(rig.right.camera, sighting.seen_px[1]));
      EXPECT_LT(std::abs(left.y() - right.y()) * rig.left.camera.fy, kTolerance_px);
      EXPECT_GT((left.x() - right.x()) * rig.left.camera.fx, 5.0);
      ++checked;
    }
  }
  EXPECT_GT(checked, 15);
}

TEST(ExactGeometry, TriangulatedDiscsAndTrueDepthAgree) {
  const StereoRig rig = Scaled(LocCamRig(), 0.5);
  const Rigid3 pose = Poses().front();
  const Camera view = TruthDepthCamera(rig);
  const cv::Mat depth = RenderTruthDepth(MarkedWorld(), view, pose);
  const auto sightings = SightingsIn(rig, pose);
  ASSERT_GE(sightings.size(), 3u);
  for (const Sighting& sighting : sightings) {
    const Eigen::Vector3d centre_in_left =
        pose.Inverse() * MarkedWorld().markers()[sighting.marker];
    const auto found =
        TriangulateStereo(rig.right_from_left, *Undistort(rig.left.camera, sighting.seen_px[0]),
                          *Undistort(rig.right.camera, sighting.seen_px[1]));
    ASSERT_TRUE(found);
    const double z_m = centre_in_left.z();
    const double error_m = 2.0 * kTolerance_px * z_m * z_m / (rig.Baseline() * rig.left.camera.fx);
    EXPECT_NEAR(found->z(), z_m, error_m);
    // The depth at the pixel nearest to the centre is that of the disc's plane there.
    const Eigen::Vector2d pixel = *Project(view, centre_in_left);
    const Eigen::Vector2i at = pixel.array().round().cast<int>();
    const Eigen::Vector3d ray = Undistort(view, at.cast<double>())->homogeneous();
    const Eigen::Vector3d up_in_left = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const double expected_m = up_in_left.dot(centre_in_left) / up_in_left.dot(ray);
    EXPECT_NEAR(depth.at<std::uint16_t>(at.y(), at.x()) * kTruthDepthUnit_m, expected_m, 1e-3);
  }
}

// Patches of the rectified pictures, compared at the true disparity and a row above and below.
TEST(ExactGeometry, RowsOfTheSandAgreeAfterRectification) {
  const StereoRig rig = Scaled(LocCamRig(), 0.5);
  const Rigid3 pose = SmallDrive().front();
  const Rectifier rectifier(rig);
  std::array<cv::Mat, 2> views;
  tbb::parallel_for(0, 2, [&](int i) {
    const ViewRenderer renderer(SmallWorld(), rig.Of(kEyes[i]).camera);
    cv::Mat grey, level;
    cv::cvtColor(TakePicture(renderer.Render(pose * FromEye(rig, kEyes[i])), {},
                             {.noise_seed = static_cast<std::uint32_t>(i)}),
                 grey, cv::COLOR_BGR2GRAY);
    grey.convertTo(level, CV_32F);
    views[i] = i == 0 ? rectifier.RectifyLeft(level) : rectifier.RectifyRight(level);
  });
  const Camera& camera = rectifier.RectifiedCamera();
  const Rigid3 world_from_rectified{pose.rotation * rectifier.LeftFromRectified(),
                                    pose.translation};
  constexpr int kHalf = 8;
  std::vector<double> rows_px, columns_px;
  for (int v = camera.height / 2; v < camera.height - 60; v += 12) {
    for (int u = camera.width / 2 - 60; u < camera.width / 2 + 120; u += 12) {
      const Eigen::Vector3d ray = Undistort(camera, Eigen::Vector2d(u, v))->homogeneous();
      const auto hit =
          SmallWorld().Cast(pose.translation, (world_from_rectified.rotation * ray).normalized());
      if (!hit || hit->kind != SurfaceKind::kSand) continue;
      const double z_m = (world_from_rectified.Inverse() * hit->position).z();
      const double disparity_px = camera.fx * rectifier.BaselineM() / z_m;
      const cv::Mat patch = views[0](cv::Rect(u - kHalf, v - kHalf, 2 * kHalf + 1, 2 * kHalf + 1));
      const auto difference = [&](double du, double dv) {
        cv::Mat other;
        cv::getRectSubPix(
            views[1], patch.size(),
            cv::Point2f(static_cast<float>(u - disparity_px + du), static_cast<float>(v + dv)),
            other);
        return cv::norm(patch, other, cv::NORM_L2SQR);
      };
      const auto lowest = [](double before, double here, double after) {
        return 0.5 * (before - after) / (before - 2.0 * here + after);
      };
      const double here = difference(0, 0);
      rows_px.push_back(lowest(difference(0, -1), here, difference(0, 1)));
      columns_px.push_back(lowest(difference(-1, 0), here, difference(1, 0)));
    }
  }
  ASSERT_GT(rows_px.size(), 60u);
  const auto median = [](std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + std::ssize(values) / 2);
    return values[values.size() / 2];
  };
  EXPECT_NEAR(median(rows_px), 0.0, 0.03);
  EXPECT_NEAR(median(columns_px), 0.0, 0.1);
  for (double& row : rows_px) row = std::abs(row);
  EXPECT_LT(median(rows_px), kTolerance_px);
}

}  // namespace
}  // namespace rigmap
