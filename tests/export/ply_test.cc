#include "export/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t kBytesPerPoint = 37;

SurfacePoint RandomPoint(SeededRandom& random) {
  SurfacePoint point;
  point.x_in_world = random.Vector(100.0).cast<float>();
  point.normal = random.Vector(1.0).normalized().cast<float>();
  for (auto& channel : point.rgb) channel = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
  point.observations = static_cast<std::uint16_t>(random.Uniform(0.0, 65536.0));
  point.sigma_m = static_cast<float>(random.Uniform(0.0, 0.1));
  point.grain_m = static_cast<float>(random.Uniform(0.0, 1.0));
  return point;
}

PointCloud RandomCloud(SeededRandom& random, int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) cloud.push_back(RandomPoint(random));
  return cloud;
}

std::string Written(std::span<const SurfacePoint> cloud, std::size_t points_per_call) {
  std::stringstream stream;
  PlyWriter writer(stream);
  for (std::size_t begin = 0; begin < cloud.size(); begin += points_per_call) {
    writer.Write(cloud.subspan(begin, std::min(points_per_call, cloud.size() - begin)));
  }
  writer.Finish();
  EXPECT_EQ(writer.point_count(), cloud.size());
  return stream.str();
}

bool operator==(const SurfacePoint& a, const SurfacePoint& b) {
  return a.x_in_world == b.x_in_world && a.normal == b.normal && a.rgb == b.rgb &&
         a.observations == b.observations && a.sigma_m == b.sigma_m && a.grain_m == b.grain_m;
}

std::string ComplaintAboutPly(const std::string& bytes) {
  const TemporaryFolder folder;
  try {
    ReadPly(WriteTestFile(folder.Path() / "cloud.ply", bytes));
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(Ply, ReadsBackToTheBitWhatItWrites) {
  SeededRandom random;
  const TemporaryFolder folder;
  const PointCloud cloud = RandomCloud(random, 10000);
  const PointCloud read =
      ReadPly(WriteTestFile(folder.Path() / "cloud.ply", Written(cloud, cloud.size())));
  ASSERT_EQ(read.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) ASSERT_TRUE(read[i] == cloud[i]) << i;
}

TEST(Ply, DoesNotDependOnHowThePointsArrive) {
  SeededRandom random;
  const PointCloud cloud = RandomCloud(random, 1234);
  const std::string at_once = Written(cloud, cloud.size());
  EXPECT_EQ(Written(cloud, 1), at_once);
  EXPECT_EQ(Written(cloud, 100), at_once);
}

TEST(Ply, KeepsTheHeadersLengthForEveryCount) {
  SeededRandom random;
  const auto header_bytes = [](const std::string& file) { return file.find("end_header\n") + 11; };
  const std::string none = Written({}, 1);
  EXPECT_EQ(none.size(), header_bytes(none));
  for (const int count : {1, 10, 12345}) {
    const std::string some = Written(RandomCloud(random, count), 5000);
    EXPECT_EQ(header_bytes(some), header_bytes(none));
    EXPECT_EQ(some.size(), header_bytes(none) + count * kBytesPerPoint);
    EXPECT_THAT(some, HasSubstr("\nelement vertex " + std::to_string(count) + "\n"));
  }
}

TEST(Ply, WritesAfterWhatTheStreamHeldBefore) {
  SeededRandom random;
  const PointCloud cloud = RandomCloud(random, 3);
  std::stringstream stream;
  stream << "before ";
  PlyWriter writer(stream);
  writer.Write(cloud);
  writer.Finish();
  stream << " after";
  EXPECT_EQ(stream.str(), "before " + Written(cloud, 3) + " after");
}

TEST(Ply, CanBeWrittenToAFileInOneGo) {
  SeededRandom random;
  const TemporaryFolder folder;
  const PointCloud cloud = RandomCloud(random, 7);
  WriteFileAtomically(folder.Path() / "cloud.ply", [&](std::ostream& stream) {
    PlyWriter writer(stream);
    writer.Write(cloud);
    writer.Finish();
  });
  EXPECT_EQ(ReadTextFile(folder.Path() / "cloud.ply"), Written(cloud, 7));
}

TEST(Ply, FailsOnAStreamThatFails) {
  std::stringstream stream;
  PlyWriter writer(stream);
  stream.setstate(std::ios::badbit);
  EXPECT_THROW(writer.Write(PointCloud(1)), DataError);
  EXPECT_THROW(writer.Finish(), DataError);
}

TEST(Ply, ReadsOtherTypesAndPassesOverOtherProperties) {
  const TemporaryFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar visible\n"
      "property double x\nproperty float32 y\nproperty int16 z\nproperty char nx\n"
      "property int red\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
  const auto append = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(std::uint8_t{1});
  append(1.5);
  append(2.5F);
  append(std::int16_t{-3});
  append(std::int8_t{-127});
  append(std::int32_t{300});
  const PointCloud cloud = ReadPly(WriteTestFile(folder.Path() / "cloud.ply", bytes));
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_EQ(cloud[0].x_in_world, Eigen::Vector3f(1.5F, 2.5F, -3.0F));
  EXPECT_EQ(cloud[0].normal, Eigen::Vector3f(-127.0F, 0.0F, 0.0F));
  EXPECT_EQ(cloud[0].rgb[0], 255);
}

TEST(Ply, NamesWhatItCannotRead) {
  SeededRandom random;
  const std::string good = Written(RandomCloud(random, 3), 3);
  EXPECT_EQ(ComplaintAboutPly(good), "");
  EXPECT_THAT(ComplaintAboutPly(good.substr(0, good.size() - 1)),
              HasSubstr("cloud.ply: expected 3 vertices of 37 bytes, found 110"));
  EXPECT_THAT(ComplaintAboutPly(good.substr(0, 60)), HasSubstr("expected 'end_header'"));
  EXPECT_THAT(ComplaintAboutPly("solid cube"), HasSubstr("cloud.ply: expected a PLY file"));
  EXPECT_THAT(ComplaintAboutPly("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("found 'ascii'"));
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  EXPECT_THAT(ComplaintAboutPly(head + "end_header\n"), HasSubstr("expected an element 'vertex'"));
  EXPECT_THAT(ComplaintAboutPly(head + "element face 3\nend_header\n"), HasSubstr("found 'face'"));
  EXPECT_THAT(ComplaintAboutPly(head + "element vertex 0\nproperty float x\nend_header\n"),
              HasSubstr("expected vertices with x, y and z"));
  EXPECT_THAT(ComplaintAboutPly(head + "element vertex 0\nproperty list uchar int x\nend_header\n"),
              HasSubstr("expected a property of fixed size, found 'list"));
  EXPECT_THROW(ReadPly("no/such/file.ply"), DataError);
}

TEST(SparsePly, HoldsPositionColourErrorAndTrackLength) {
  const TemporaryFolder folder;
  std::vector<SparsePoint> points(2);
  points[1].x_in_model = {1.5, -2.25, 3.0};
  points[1].rgb = {10, 20, 30};
  points[1].error_px = 0.5;
  points[1].track.resize(7);
  std::stringstream stream;
  WriteSparsePly(stream, points);
  const std::string bytes = stream.str();
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  std::uint32_t track_length = 0;
  std::memcpy(&track_length, bytes.data() + bytes.size() - 4, 4);
  EXPECT_EQ(track_length, 7U);
  float error_px = 0.0F;
  std::memcpy(&error_px, bytes.data() + bytes.size() - 8, 4);
  EXPECT_EQ(error_px, 0.5F);
  const PointCloud read = ReadPly(WriteTestFile(folder.Path() / "sparse.ply", bytes));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].x_in_world, Eigen::Vector3f(1.5F, -2.25F, 3.0F));
  EXPECT_EQ(read[1].rgb, points[1].rgb);
}

}  // namespace
}  // namespace rigmap
