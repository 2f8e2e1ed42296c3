#include "fusion/internal/tiled_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr double kVoxelM = 0.01;
constexpr double kTileM = 256 * kVoxelM;
constexpr std::size_t kPlenty = 1'000'000;

// Some samples to each of 3000 places in about 25 tiles.
std::vector<SurfaceSample> ManySamples() {
  SeededRandom random;
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 3000; ++i) positions.push_back(random.Vector(2.5 * kTileM));
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < 20000; ++i) {
    SurfaceSample sample;
    const auto index = static_cast<std::size_t>(random.Uniform(0.0, 3000.0));
    sample.x_in_world = positions[index] + random.Vector(0.5 * kVoxelM);
    sample.normal = random.Vector(1.0).normalized().cast<float>();
    sample.rgb = {static_cast<std::uint8_t>(random.Uniform(0.0, 256.0)), 20, 30};
    sample.sigma_m = static_cast<float>(random.Uniform(0.005, 0.05));
    sample.observations = 1 + i % 3;
    samples.push_back(sample);
  }
  return samples;
}

auto FieldsOf(const SurfacePoint& point) {
  const auto &x = point.x_in_world, &n = point.normal;
  return std::tuple(x.x(), x.y(), x.z(), n.x(), n.y(), n.z(), point.rgb, point.observations,
                    point.sigma_m);
}

// A sample in the middle of a tile.
SurfaceSample SampleInTile(int x, int y) {
  SurfaceSample sample;
  sample.x_in_world = {(x + 0.5) * kTileM, (y + 0.5) * kTileM, 0.0};
  sample.normal = Eigen::Vector3f::UnitZ();
  sample.sigma_m = 0.01F;
  return sample;
}

int FileCount(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

class TiledGridInScratch : public testing::Test {
 protected:
  // What comes out tile by tile when something is set aside after every 4000 samples.
  std::vector<PointCloud> Pieces(const std::vector<SurfaceSample>& samples,
                                 std::size_t most_voxels) {
    TiledGrid grid(kVoxelM, kTileM, scratch_, most_voxels);
    most_files_ = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      grid.Add(samples[i]);
      if (i % 4000 != 3999) continue;
      grid.SetAside();
      most_files_ = std::max(most_files_, FileCount(scratch_));
    }
    std::vector<PointCloud> pieces;
    for (const TileIndex& tile : grid.Tiles()) pieces.push_back(grid.Take(tile, 2, 0.04));
    return pieces;
  }

  TemporaryFolder folder_;
  fs::path scratch_ = folder_.Path() / "in" / "scratch";
  int most_files_ = 0;
};

TEST_F(TiledGridInScratch, GivesTheSameWhateverIsSetAside) {
  const auto samples = ManySamples();
  const auto in_memory = Pieces(samples, kPlenty);
  EXPECT_EQ(most_files_, 0);
  for (const std::size_t most_voxels : {0, 1000}) {
    const auto through_files = Pieces(samples, most_voxels);
    EXPECT_GT(most_files_, 20);
    ASSERT_EQ(through_files.size(), in_memory.size());
    for (std::size_t i = 0; i < in_memory.size(); ++i) {
      ASSERT_EQ(through_files[i].size(), in_memory[i].size());
      for (std::size_t k = 0; k < in_memory[i].size(); ++k) {
        ASSERT_EQ(FieldsOf(through_files[i][k]), FieldsOf(in_memory[i][k]));
      }
    }
  }
}

TEST_F(TiledGridInScratch, GivesWhatOneGridWouldGive) {
  const auto samples = ManySamples();
  VoxelGrid whole(kVoxelM);
  for (const SurfaceSample& sample : samples) whole.Add(sample);
  PointCloud expected = whole.Points(2, 0.04), found;
  for (const PointCloud& piece : Pieces(samples, 0)) {
    found.insert(found.end(), piece.begin(), piece.end());
  }
  ASSERT_GT(expected.size(), 3000U);
  ASSERT_EQ(found.size(), expected.size());
  const auto before = [](const auto& a, const auto& b) { return FieldsOf(a) < FieldsOf(b); };
  std::sort(expected.begin(), expected.end(), before);
  std::sort(found.begin(), found.end(), before);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(FieldsOf(found[i]), FieldsOf(expected[i]));
  }
}

// 26 km at 1 cm, where the position in the cloud is good to 2 mm.
TEST_F(TiledGridInScratch, ReachesAsFarAsTheTraverseDoes) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, kPlenty);
  for (const auto& [x, y] : {std::pair(10'000, -10'000), std::pair(-10'000, 3)}) {
    const SurfaceSample sample = SampleInTile(x, y);
    grid.Add(sample);
    const PointCloud points = grid.Take({x, y}, 1, 1.0);
    ASSERT_EQ(points.size(), 1U);
    EXPECT_LT((points[0].x_in_world.cast<double>() - sample.x_in_world).norm(), 0.002);
  }
}

TEST_F(TiledGridInScratch, OrdersByTileThenVoxel) {
  const auto cells = [](const SurfacePoint& point, double side_m, int axes) {
    const Eigen::Vector3d cell = (point.x_in_world.cast<double>() / side_m).array().floor();
    return std::vector<double>(cell.data(), cell.data() + axes);
  };
  std::vector<double> last_tile;
  int pieces = 0;
  for (const PointCloud& piece : Pieces(ManySamples(), 0)) {
    if (piece.empty()) continue;
    const auto tile = cells(piece.front(), kTileM, 2);
    EXPECT_LT(last_tile, tile);
    last_tile = tile;
    ++pieces;
    for (const SurfacePoint& point : piece) ASSERT_EQ(cells(point, kTileM, 2), tile);
    EXPECT_TRUE(std::is_sorted(piece.begin(), piece.end(), [&](const auto& a, const auto& b) {
      return cells(a, kVoxelM, 3) < cells(b, kVoxelM, 3);
    }));
  }
  EXPECT_GT(pieces, 20);
}

TEST_F(TiledGridInScratch, GivesATileOnce) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, kPlenty);
  grid.Add(SampleInTile(3, -2));
  ASSERT_EQ(grid.Tiles(), (std::vector<TileIndex>{{3, -2}}));
  EXPECT_TRUE(grid.Take({0, 0}, 1, 1.0).empty());
  EXPECT_EQ(grid.Take({3, -2}, 1, 1.0).size(), 1U);
  EXPECT_TRUE(grid.Tiles().empty());
  EXPECT_TRUE(grid.Take({3, -2}, 1, 1.0).empty());
}

TEST_F(TiledGridInScratch, SetsAsideWhatIsLongestUnused) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, 2);
  for (const int x : {0, 1, 2, 0}) grid.Add(SampleInTile(x, 0));
  grid.SetAside();
  ASSERT_EQ(FileCount(scratch_), 1);
  grid.Add(SampleInTile(0, 0));
  grid.Add(SampleInTile(2, 0));
  fs::remove(fs::directory_iterator(scratch_)->path());
  EXPECT_THROW(grid.Add(SampleInTile(1, 0)), DataError);
}

TEST_F(TiledGridInScratch, RemovesItsFolder) {
  fs::create_directories(scratch_);
  std::ofstream(scratch_ / "0_0") << "left over from a run that was killed";
  {
    TiledGrid grid(kVoxelM, kTileM, scratch_, 0);
    EXPECT_EQ(FileCount(scratch_), 0);
    grid.Add(SampleInTile(0, 0));
    grid.SetAside();
    EXPECT_EQ(FileCount(scratch_), 1);
  }
  EXPECT_FALSE(fs::exists(scratch_));
}

TEST_F(TiledGridInScratch, NamesAFolderThatCannotBeMade) {
  const fs::path below_a_file = folder_.Write("file", "text") / "scratch";
  EXPECT_THAT(MessageOf<DataError>([&] { TiledGrid(kVoxelM, kTileM, below_a_file, kPlenty); }),
              testing::HasSubstr(below_a_file.string()));
}

TEST_F(TiledGridInScratch, NamesAFileThatCannotBeWritten) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, 0);
  grid.Add(SampleInTile(0, 0));
  fs::remove_all(scratch_);
  EXPECT_THAT(MessageOf<DataError>([&] { grid.SetAside(); }),
              testing::HasSubstr(scratch_.string()));
}

TEST_F(TiledGridInScratch, NamesAFileThatIsGone) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, 0);
  grid.Add(SampleInTile(0, 0));
  grid.SetAside();
  const fs::path file = fs::directory_iterator(scratch_)->path();
  fs::remove(file);
  const auto take = [&] { grid.Take(grid.Tiles().front(), 1, 1.0); };
  EXPECT_THAT(MessageOf<DataError>(take), testing::HasSubstr(file.string()));
}

TEST_F(TiledGridInScratch, NamesAFileThatWasCut) {
  for (const double share : {0.0, 0.3, 0.5, 0.99}) {
    TiledGrid grid(kVoxelM, kTileM, scratch_, 0);
    for (int i = 0; i < 100; ++i) {
      SurfaceSample sample = SampleInTile(0, 0);
      sample.x_in_world.z() = i * kVoxelM;
      grid.Add(sample);
    }
    grid.SetAside();
    const fs::path file = fs::directory_iterator(scratch_)->path();
    fs::resize_file(file,
                    static_cast<std::uintmax_t>(share * static_cast<double>(fs::file_size(file))));
    EXPECT_THAT(MessageOf<DataError>([&] { grid.Add(SampleInTile(0, 0)); }),
                testing::HasSubstr(file.string()))
        << share;
  }
}

TEST_F(TiledGridInScratch, RefusesPointsOutsideTheWorld) {
  TiledGrid grid(kVoxelM, kTileM, scratch_, kPlenty);
  SurfaceSample sample = SampleInTile(0, 0);
  for (const double x_m : {2e5, -1e300, HUGE_VAL, std::nan("")}) {
    sample.x_in_world.x() = x_m;
    EXPECT_THROW(grid.Add(sample), DataError);
  }
}

}  // namespace
}  // namespace rigmap
