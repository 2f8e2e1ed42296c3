#include "simulation/internal/truth_surface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <fstream>

#include "core/file.h"
#include "export/ply.h"
#include "export/ply_header.h"
#include "tests/simulation/small_world.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

struct FilePoint {
  Eigen::Vector3d position, normal;
  bool visible;
  int kind;
};

std::vector<FilePoint> ReadPoints(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const PlyHeader header = ReadPlyHeader(stream, file.string());
  std::vector<FilePoint> points;
  std::vector<char> row(header.row_bytes);
  const auto value = [&](const char* name) { return PlyValue(*header.Find(name), row.data()); };
  while (stream.read(row.data(), static_cast<std::streamsize>(row.size()))) {
    points.push_back({{value("x"), value("y"), value("z")},
                      {value("nx") / 127.0, value("ny") / 127.0, value("nz") / 127.0},
                      value("visible") == 1.0,
                      static_cast<int>(value("kind"))});
  }
  EXPECT_EQ(points.size(), header.vertex_count);
  return points;
}

bool IsInside(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  const auto pixel = Project(camera, x_in_camera);
  return pixel && camera.Contains(*pixel);
}

// How many frames see the point, by asking the world for what stands first on the ray from the
// camera; the answer may differ where a ray only just passes.
int FramesThatSee(const FilePoint& point, const StereoRig& rig, std::span<const Rigid3> drive) {
  int frames = 0;
  for (const Rigid3& pose : drive) {
    const Eigen::Vector3d x_in_left = pose.Inverse() * point.position;
    if (!IsInside(rig.left.camera, x_in_left)) continue;
    if (!IsInside(rig.right.camera, rig.right_from_left * x_in_left)) continue;
    const Eigen::Vector3d ray = point.position - pose.translation;
    if (ray.norm() < 0.4 || ray.norm() > 6.0 || point.normal.dot(ray) >= 0.0) continue;
    const auto hit = SmallWorld().Cast(pose.translation, ray.normalized());
    frames += hit && hit->distance_m > ray.norm() - 1.2e-3;
  }
  return frames;
}

class TruthSurface : public testing::Test {
 protected:
  TruthSurfaceSummary Write(std::span<const Rigid3> drive, const std::string& name) {
    const auto outline = SmallOutline();
    const SurfaceSampler sampler(SmallWorld(), outline, 3.6);
    return WriteTruthSurface(folder_.Path() / name, sampler,
                             SurfaceVisibility(SmallWorld(), rig_, drive));
  }

  const TemporaryFolder folder_;
  const StereoRig rig_ = LocCamRig();
  const std::vector<Rigid3> drive_ = SmallDrive();
};

TEST_F(TruthSurface, VisibleIsWhatTwoFramesSee) {
  Write(drive_, "surface.ply");
  const auto points = ReadPoints(folder_.Path() / "surface.ply");
  int checked = 0, visible = 0, differing = 0;
  for (std::size_t i = 0; i < points.size(); i += 7) {
    const bool expected = FramesThatSee(points[i], rig_, drive_) >= 2;
    differing += points[i].visible != expected;
    visible += points[i].visible;
    ++checked;
  }
  EXPECT_GT(visible, checked / 20);
  EXPECT_LT(visible, checked * 9 / 10);
  EXPECT_LE(differing, checked / 200);  // rounded normals, rays that only just pass
}

TEST_F(TruthSurface, VisiblePointsProjectIntoBothImages) {
  Write(drive_, "surface.ply");
  int visible = 0;
  for (const FilePoint& point : ReadPoints(folder_.Path() / "surface.ply")) {
    if (!point.visible) continue;
    ++visible;
    const auto frames = std::count_if(drive_.begin(), drive_.end(), [&](const Rigid3& pose) {
      const Eigen::Vector3d x_in_left = pose.Inverse() * point.position;
      return IsInside(rig_.left.camera, x_in_left) &&
             IsInside(rig_.right.camera, rig_.right_from_left * x_in_left);
    });
    EXPECT_GE(frames, 2);
  }
  EXPECT_GT(visible, 0);
}

TEST_F(TruthSurface, ReadsBackAsAPointCloud) {
  const TruthSurfaceSummary summary = Write(drive_, "surface.ply");
  const auto path = folder_.Path() / "surface.ply";
  const PointCloud cloud = ReadPly(path);
  const auto points = ReadPoints(path);
  ASSERT_EQ(cloud.size(), summary.points);
  ASSERT_EQ(cloud.size(), points.size());
  std::uint64_t visible = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].x_in_world.cast<double>(), points[i].position);
    EXPECT_NEAR(points[i].normal.norm(), 1.0, 0.01);
    EXPECT_TRUE(points[i].kind == 0 || points[i].kind == 2 || points[i].kind == 3);
    visible += points[i].visible;
  }
  EXPECT_EQ(visible, summary.visible);
}

TEST_F(TruthSurface, OneFrameAloneShowsNothingTwice) {
  EXPECT_EQ(Write(std::span(drive_).first(1), "one.ply").visible, 0u);
  EXPECT_EQ(Write({}, "none.ply").visible, 0u);
}

TEST_F(TruthSurface, BytesDoNotDependOnThreadsOrTheOrderOfFrames) {
  Write(drive_, "a.ply");
  const std::vector<Rigid3> reversed(drive_.rbegin(), drive_.rend());
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Write(reversed, "b.ply");
  }
  EXPECT_EQ(ReadTextFile(folder_.Path() / "a.ply"), ReadTextFile(folder_.Path() / "b.ply"));
}

}  // namespace
}  // namespace rigmap
