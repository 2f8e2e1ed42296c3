// What the writer leaves, read by a reader of its own: read_las.py, after the specification.
#include "export/las.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using nlohmann::json;

PointCloud RandomLasCloud(SeededRandom& random, int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    SurfacePoint point;
    point.x_in_world = random.Vector(50.0).cast<float>();
    for (auto& channel : point.rgb) {
      channel = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
    }
    point.observations = static_cast<std::uint16_t>(i);
    point.sigma_m = 0.001F * static_cast<float>(i);
    cloud.push_back(point);
  }
  return cloud;
}

std::string LasOf(const PointCloud& cloud, const LasFrame& frame) {
  std::ostringstream stream;
  LasWriter writer(stream, frame);
  const std::span<const SurfacePoint> points(cloud);
  const auto half = points.size() / 2;
  for (const auto& part : {points.first(half), points.subspan(half)}) writer.Bound(part);
  for (const auto& part : {points.first(half), points.subspan(half)}) writer.Write(part);
  writer.Finish();
  return stream.str();
}

json ReadByAnother(const std::string& bytes) {
  const TemporaryFolder folder;
  WriteTestFile(folder.Path() / "cloud.las", bytes);
  const std::string command = std::string("/usr/bin/python3 ") + RIGMAP_LAS_READER + " " +
                              (folder.Path() / "cloud.las").string();
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start python3");
  std::string text;
  std::array<char, 65536> buffer;
  while (const auto read = fread(buffer.data(), 1, buffer.size(), pipe)) {
    text.append(buffer.data(), read);
  }
  EXPECT_EQ(pclose(pipe), 0);
  return json::parse(text);
}

TEST(Las, PointsComeBackByAReaderOfTheSpecification) {
  SeededRandom random;
  const PointCloud cloud = RandomLasCloud(random, 500);
  const json las = ReadByAnother(LasOf(cloud, {}));
  ASSERT_EQ(las["count"], 500);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const json& point = las["points"][i];
    for (int k = 0; k < 3; ++k) {
      ASSERT_NEAR(point["xyz"][k], cloud[i].x_in_world(k), 0.51e-4);  // m
      ASSERT_EQ(point["rgb"][k], 257 * cloud[i].rgb[k]);
    }
    ASSERT_EQ(point["observations"], cloud[i].observations);
    ASSERT_FLOAT_EQ(point["sigma"], cloud[i].sigma_m);
  }
  EXPECT_EQ(las["day"], 0);
  EXPECT_EQ(las["year"], 0);
  ASSERT_EQ(las["records"].size(), 1U) << "a local system is not stated";
}

TEST(Las, CoordinatesOfAGridKeepTheirTenthOfAMillimetre) {
  SeededRandom random;
  const PointCloud cloud = RandomLasCloud(random, 50);
  const Eigen::Vector3d shift(595676.54, 5785775.6, 48.2);
  const json las = ReadByAnother(LasOf(
      cloud, {[&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return x + shift; }, 32631}));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_NEAR(las["points"][i]["xyz"][k],
                  static_cast<double>(cloud[i].x_in_world(k)) + shift(k), 0.51e-4);
    }
  }
  const json& keys = las["records"][1]["keys"];
  EXPECT_EQ(keys["1024"], 1) << "projected";
  EXPECT_EQ(keys["3072"], 32631);
  EXPECT_EQ(keys["3076"], 9001);
}

TEST(Las, BearsItsWarning) {
  const json las = ReadByAnother(LasOf({}, {{}, 0, "not trusted: a"}));
  EXPECT_EQ(las["count"], 0);
  EXPECT_EQ(las["records"][1]["text"], "not trusted: a");
}

TEST(Las, EqualCloudsGiveEqualBytesAndStrayPointsAreLeftOut) {
  SeededRandom random;
  PointCloud cloud = RandomLasCloud(random, 20);
  const std::string bytes = LasOf(cloud, {});
  EXPECT_EQ(LasOf(cloud, {}), bytes);
  cloud.push_back(cloud.back());
  cloud.back().x_in_world.x() = NAN;
  EXPECT_EQ(LasOf(cloud, {}), bytes);
}

TEST(Las, RefusesWhatItsStepsCannotReach) {
  SeededRandom random;
  PointCloud cloud = RandomLasCloud(random, 2);
  cloud[1].x_in_world.x() = 1e6F;
  EXPECT_THROW(LasOf(cloud, {}), DataError);
}

}  // namespace
}  // namespace rigmap
