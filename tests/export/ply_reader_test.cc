#include "export/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "export/ply.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

PointCloud CountingCloud(std::size_t count) {
  PointCloud cloud(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud[i].x_in_world = Eigen::Vector3f(static_cast<float>(i), 0.5F, -1.0F);
    cloud[i].rgb[1] = static_cast<std::uint8_t>(i);
  }
  return cloud;
}

std::filesystem::path Write(const std::filesystem::path& path, const PointCloud& cloud) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    PlyWriter writer(stream);
    writer.Write(cloud);
    writer.Finish();
  });
  return path;
}

TEST(PlyReader, GivesAllPointsInOrderInBlocks) {
  const TemporaryFolder folder;
  constexpr std::size_t kBlock = PlyReader::kMaxPointsPerBlock;
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, kBlock, 2 * kBlock + 3}) {
    PlyReader reader(Write(folder.Path() / "cloud.ply", CountingCloud(count)));
    EXPECT_EQ(reader.point_count(), count);
    std::size_t seen = 0;
    PointCloud block;
    while (reader.Read(block)) {
      EXPECT_EQ(block.size(), std::min(kBlock, count - seen));
      for (const SurfacePoint& point : block) {
        ASSERT_EQ(point.x_in_world.x(), static_cast<float>(seen));
        ASSERT_EQ(point.rgb[1], static_cast<std::uint8_t>(seen));
        ++seen;
      }
    }
    EXPECT_EQ(seen, count);
    EXPECT_TRUE(block.empty());
    EXPECT_FALSE(reader.Read(block));  // and stays at the end
  }
}

TEST(PlyReader, RefusesWithTheSameWordsAsReadPly) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "cloud.ply";
  const std::string good = ReadTextFile(Write(path, CountingCloud(3)));
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& bad :
       {good.substr(0, good.size() - 1), good.substr(0, 60), std::string("solid cube"),
        head + "element vertex 0\nproperty float x\nend_header\n"}) {
    WriteTestFile(path, bad);
    const std::string complaint = MessageOf<DataError>([&] { PlyReader reader(path); });
    EXPECT_THAT(complaint, HasSubstr("cloud.ply: expected"));
    EXPECT_EQ(complaint, MessageOf<DataError>([&] { ReadPly(path); }));
  }
  EXPECT_THAT(MessageOf<DataError>([&] { PlyReader reader(folder.Path()); }),
              HasSubstr("cannot read"));
}

TEST(PlyReader, NoticesAFileThatShrinksWhileItIsRead) {
  const TemporaryFolder folder;
  const auto path = Write(folder.Path() / "cloud.ply", CountingCloud(30000));
  PlyReader reader(path);
  PointCloud block;
  ASSERT_TRUE(reader.Read(block));
  std::filesystem::resize_file(path, 300000);
  EXPECT_THAT(MessageOf<DataError>([&] {
                while (reader.Read(block)) {
                }
              }),
              HasSubstr("cloud.ply: cannot read its vertices"));
}

}  // namespace
}  // namespace rigmap
