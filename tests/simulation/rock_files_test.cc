#include "simulation/internal/rock_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "georeference/utm_grid.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

const Geodetic kOrigin{52.2141, 4.4004, 4.08};

std::vector<Boulder> BouldersInARow() {
  std::vector<Boulder> boulders;
  const char* sizes[] = {"small", "medium", "large"};
  for (int i = 0; i < 300; ++i) {
    Boulder boulder;
    boulder.size = sizes[i % 3];
    boulder.centre = Eigen::Vector3d(0.7 * i, 40.0 - 0.3 * i, 0.1);
    boulders.push_back(boulder);
  }
  return boulders;
}

std::vector<Eigen::Vector2d> ReadRows(const std::filesystem::path& file) {
  std::istringstream text(ReadTextFile(file));
  std::vector<Eigen::Vector2d> rows;
  for (Eigen::Vector2d row; text >> row.x() >> row.y();) rows.push_back(row);
  return rows;
}

TEST(RockFiles, RowsAreTheBouldersOfTheirSizeWithinTheSurveysError) {
  const TemporaryFolder folder;
  const LocalFrame local(kOrigin);
  const auto boulders = BouldersInARow();
  WriteRockFiles(folder.Path(), 3, boulders, local, 1);
  double sum2 = 0.0;
  for (int size = 0; size < 3; ++size) {
    const std::string name = boulders[size].size + "-rocks-traverse3.txt";
    const auto rows = ReadRows(folder.Path() / "Rock Data" / "Rock Positions Traverse 3" / name);
    ASSERT_EQ(rows.size(), 100u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Geodetic position = FromUtm(kUtm31, rows[i].x(), rows[i].y(), kOrigin.altitude_m);
      const Eigen::Vector3d error =
          local.ToEnu(position) - boulders[3 * i + static_cast<std::size_t>(size)].centre;
      EXPECT_LT(error.head<2>().norm(), 6.0 * kRockSurveySigma_m);
      sum2 += error.head<2>().squaredNorm();
    }
  }
  // The standard deviation from 600 numbers is good to 3 %; 12 % are four times that.
  EXPECT_NEAR(std::sqrt(sum2 / 600.0), kRockSurveySigma_m, 0.12 * kRockSurveySigma_m);
}

TEST(RockFiles, FirstTraversesShareTheirFiles) {
  const TemporaryFolder folder;
  const LocalFrame local(kOrigin);
  const auto file = folder.Path() / "Rock Data" / "Rock Positions Traverse 1 and 2" /
                    "large-rocks-traverse12.txt";
  WriteRockFiles(folder.Path(), 1, BouldersInARow(), local, 4);
  const std::string first = ReadTextFile(file);
  WriteRockFiles(folder.Path(), 2, BouldersInARow(), local, 4);
  EXPECT_EQ(ReadTextFile(file), first);
  WriteRockFiles(folder.Path(), 2, BouldersInARow(), local, 5);
  EXPECT_NE(ReadTextFile(file), first);
}

TEST(RockFiles, RefuseOtherTraverses) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteRockFiles(folder.Path(), 4, BouldersInARow(), LocalFrame(kOrigin), 1),
               UsageError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

}  // namespace
}  // namespace rigmap
