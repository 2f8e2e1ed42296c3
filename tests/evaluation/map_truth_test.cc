#include "evaluation/map_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "evaluation/map_over_truth.h"
#include "tests/evaluation/ply_text.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::Test;

constexpr const char* kPath = "1.0 0 0 1 0 0 0 1\n2.0 0.5 0 1 0 0 0 1\n";
constexpr const char* kRocks =
    R"({"note": "n", "rocks": [{"size": "large", "x": 1.5, "y": -2, "z": 0.25, "width": 1.1}]})";

TrueSurface TwoPoints() {
  return {{{1.0F, 2.0F, 3.0F}, {-1.5F, 0.25F, 0.125F}},
          {{0.0F, 0.0F, 1.0F}, {0.0F, -1.0F, 0.0F}},
          {1, 0},
          {0, kRockKind}};
}

class ReadMapTruthTest : public Test {
 protected:
  std::filesystem::path Part() const { return folder_.Path() / "Part1"; }
  std::filesystem::path WriteSurface(int left_out = 0) const {
    folder_.Write("Part1/trajectory.tum", kPath);
    return folder_.Write("Part1/surface.ply", SurfacePly(TwoPoints(), left_out));
  }
  std::string Complaint() const {
    return MessageOf<DataError>([&] { Read(); });
  }
  std::optional<MapTruth> Read() const {
    return ReadMapTruth({Part()}, ReadTum(Part() / "trajectory.tum"));
  }

  TemporaryFolder folder_;
};

TEST_F(ReadMapTruthTest, ReadsBackWhatWasWritten) {
  WriteSurface();
  folder_.Write("rocks.json", kRocks);
  const auto truth = Read();
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->path.size(), 2U);
  const TrueSurface expected = TwoPoints();
  EXPECT_EQ(truth->surface.x_in_truth, expected.x_in_truth);
  EXPECT_EQ(truth->surface.normal, expected.normal);
  EXPECT_EQ(truth->surface.visible, expected.visible);
  EXPECT_EQ(truth->surface.kind, expected.kind);
  ASSERT_EQ(truth->rocks.size(), 1U);
  EXPECT_EQ(truth->rocks[0].size, "large");
  EXPECT_EQ(truth->rocks[0].x_in_truth, Eigen::Vector3d(1.5, -2.0, 0.25));
  EXPECT_EQ(truth->rocks[0].width_m, 1.1);
}

TEST_F(ReadMapTruthTest, PartsAreOneSurfaceWithPointsOfBothOnce) {
  WriteSurface();
  folder_.Write("rocks.json", kRocks);
  TrueSurface other = TwoPoints();
  other.x_in_truth[0].x() = 7.0F;
  other.visible = {0, 1};
  folder_.Write("Part2/surface.ply", SurfacePly(other, 0));
  const auto path = ReadTum(Part() / "trajectory.tum");
  const auto truth = ReadMapTruth({Part(), folder_.Path() / "Part2"}, path);
  ASSERT_TRUE(truth);
  ASSERT_EQ(truth->surface.size(), 3U);
  EXPECT_EQ(truth->surface.x_in_truth[2].x(), 7.0F);
  EXPECT_EQ(truth->surface.visible, (std::vector<std::uint8_t>{1, 1, 0}));
  EXPECT_EQ(truth->rocks.size(), 1U);
  EXPECT_FALSE(ReadMapTruth({Part(), folder_.Path() / "nowhere"}, path));
  EXPECT_EQ(MapTruthFiles({Part(), folder_.Path() / "Part2"}).size(), 3U);
}

TEST_F(ReadMapTruthTest, HasNothingWithoutASurface) {
  folder_.Write("Part1/trajectory.tum", kPath);
  EXPECT_FALSE(Read());
  WriteSurface();
  EXPECT_TRUE(Read());
  EXPECT_FALSE(ReadMapTruth({Part()}, {}));
}

TEST_F(ReadMapTruthTest, HasTheSurfaceAroundThePathAlone) {
  TrueSurface surface;  // every 10 cm, 40 m across the path
  for (int i = -200; i <= 200; ++i) {
    surface.x_in_truth.emplace_back(0.25F, 0.1F * static_cast<float>(i), 0.0F);
    surface.normal.emplace_back(0.0F, 0.0F, 1.0F);
    surface.visible.push_back(1);
    surface.kind.push_back(0);
  }
  WriteSurface();
  folder_.Write("Part1/surface.ply", SurfacePly(surface, 0));
  const auto truth = Read();
  ASSERT_TRUE(truth);
  const auto [least, most] = std::ranges::minmax_element(
      truth->surface.x_in_truth, {}, [](const Eigen::Vector3f& x) { return x.y(); });
  EXPECT_LE(least->y(), -8.0F);
  EXPECT_GE(least->y(), -10.0F);
  EXPECT_GE(most->y(), 8.0F);
  EXPECT_LE(most->y(), 10.0F);
  EXPECT_EQ(truth->surface.size(), 1 + std::lround(10 * (most->y() - least->y())));
}

TEST_F(ReadMapTruthTest, HasNoRocksWithoutTheirFile) {
  WriteSurface();
  EXPECT_TRUE(Read()->rocks.empty());
}

TEST_F(ReadMapTruthTest, NamesAMissingProperty) {
  const auto file = WriteSurface(2);
  EXPECT_EQ(
      Complaint(),
      file.string() + ": expected vertices with a property 'visible', found 'x y z nx ny nz'");
}

TEST_F(ReadMapTruthTest, NeedsKindsWhereThereAreRocks) {
  const auto file = WriteSurface(1);
  EXPECT_EQ(Read()->surface.kind, std::vector<std::uint8_t>(2, 0));
  folder_.Write("rocks.json", kRocks);
  EXPECT_EQ(
      Complaint(),
      file.string() + ": expected vertices with a property 'kind', found 'x y z nx ny nz visible'");
}

TEST_F(ReadMapTruthTest, NamesATruncatedSurface) {
  const auto file = WriteSurface();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_EQ(Complaint(), file.string() + ": expected 2 vertices of 17 bytes, found 33 bytes");
}

TEST_F(ReadMapTruthTest, NamesRocksThatAreNone) {
  WriteSurface();
  const std::string file = (folder_.Path() / "rocks.json").string();
  for (const char* text : {"", "[1]", "{}", R"({"rocks": [{"size": "small", "x": 1}]})",
                           R"({"rocks": [{"size": 1, "x": 1, "y": 1, "z": 1, "width": 1}]})"}) {
    folder_.Write("rocks.json", text);
    const std::string complaint = Complaint();
    EXPECT_EQ(complaint, file +
                             ": expected JSON with 'rocks', each with size, x, y, z and width, "
                             "found something else")
        << text;
  }
}

TEST(ReadMapPoints, ReadsBackMoreThanABlock) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 200'000; ++i) points.emplace_back(0.5F * i, -1.0F * i, 0.25F);
  const TemporaryFolder folder;
  EXPECT_EQ(ReadMapPoints(folder.Write("map.ply", MapPly(points))), points);
  EXPECT_TRUE(ReadMapPoints(folder.Write("empty.ply", MapPly({}))).empty());
}

TEST(ReadMapSigmas, AreThoseOfTheFileIfItHasAny) {
  std::string bytes =
      PlyHead(2, "property float x\nproperty float y\nproperty float z\nproperty float sigma\n");
  for (const float value : {0.0F, 0.0F, 1.0F, 0.002F, 1.0F, 0.0F, 1.0F, 0.5F}) {
    AppendBytes(bytes, value);
  }
  const TemporaryFolder folder;
  EXPECT_EQ(ReadMapSigmas(folder.Write("map.ply", bytes)), (std::vector<float>{0.002F, 0.5F}));
  EXPECT_TRUE(ReadMapSigmas(folder.Write("bare.ply", MapPly({{0, 0, 1}}))).empty());
}

TEST(ReadMapPoints, NamesAPointThatIsNowhere) {
  std::vector<Eigen::Vector3f> points(100'000, Eigen::Vector3f::Zero());
  points[98'765].y() = std::numeric_limits<float>::quiet_NaN();
  const TemporaryFolder folder;
  const auto file = folder.Write("map.ply", MapPly(points));
  EXPECT_EQ(MessageOf<DataError>([&] { ReadMapPoints(file); }),
            file.string() + ": expected finite numbers, found nan as y of vertex 98765");
}

TEST(ReadMapPoints, NamesAFileThatIsMissingOrHasNoVertices) {
  const TemporaryFolder folder;
  const auto missing = folder.Path() / "none.ply";
  EXPECT_EQ(MessageOf<DataError>([&] { ReadMapPoints(missing); }),
            missing.string() + ": cannot read: No such file or directory");
  const auto empty = folder.Write("empty.ply", PlyHead(3, ""));
  EXPECT_EQ(MessageOf<DataError>([&] { ReadMapPoints(empty); }),
            empty.string() + ": expected vertices with properties, found none");
}

}  // namespace
}  // namespace rigmap
