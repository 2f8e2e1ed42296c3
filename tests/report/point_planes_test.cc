#include "report/point_planes.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

std::vector<std::uint8_t> FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char character : text) {
    if (character == '=') break;
    group = (group << 6) | static_cast<unsigned>(digits.find(character));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<std::uint8_t>(group >> (bits -= 8)));
  }
  return bytes;
}

// As the page's points.js does it.
PointCloud Unpack(const PackedPoints& packed) {
  PointCloud points;
  for (const PackedLevel& level : packed.levels) {
    const std::size_t n = level.count;
    const auto deflated = FromBase64(level.text);
    std::vector<std::uint8_t> planes(18 * n);
    uLongf size = planes.size();
    EXPECT_EQ(uncompress(planes.data(), &size, deflated.data(), deflated.size()), Z_OK);
    EXPECT_EQ(size, planes.size());
    std::array<std::uint32_t, 3> steps{};
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t i = 0; i < n; ++i) {
      SurfacePoint point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::uint32_t coded = 0;
        for (std::size_t byte = 0; byte < 4; ++byte) {
          coded |= std::uint32_t{planes[(4 * axis + byte) * n + i]} << (8 * byte);
        }
        steps[axis] += (coded >> 1) ^ (0U - (coded & 1U));
        point.x_in_world[static_cast<int>(axis)] =
            static_cast<float>(packed.origin_m[axis] + steps[axis] * packed.step_m);
        colour[axis] = static_cast<std::uint8_t>(colour[axis] + planes[(12 + axis) * n + i]);
      }
      point.rgb = {static_cast<std::uint8_t>(colour[1] + colour[0]), colour[0],
                   static_cast<std::uint8_t>(colour[2] + colour[0])};
      const int sigma = planes[15 * n + i];
      point.sigma_m = sigma == 0 ? 0.0F : 1e-5F * std::exp2(static_cast<float>(sigma - 1) / 12.0);
      point.observations =
          static_cast<std::uint16_t>(std::lround(std::exp2(planes[16 * n + i] / 16.0)));
      point.grain_m = static_cast<float>(packed.finest_m * std::exp2(planes[17 * n + i] / 4.0));
      points.push_back(point);
    }
  }
  return points;
}

PointCloud RandomPoints(std::size_t count, double extent_m) {
  SeededRandom random;
  const auto byte = [&] { return static_cast<int>(random.Uniform(0.0, 256.0)); };
  PointCloud points(count);
  for (SurfacePoint& point : points) {
    for (int axis = 0; axis < 3; ++axis) {
      point.x_in_world[axis] = static_cast<float>(random.Uniform(-extent_m, extent_m));
    }
    for (std::uint8_t& channel : point.rgb) channel = static_cast<std::uint8_t>(byte());
    point.sigma_m = 1e-4F * static_cast<float>(1 + byte());
    point.observations = static_cast<std::uint16_t>(1 + byte());
    point.grain_m = byte() < 128 ? 0.01F : 0.08F;
  }
  return points;
}

// Each colour is drawn at random, so that it tells which point is which.
void ExpectSame(PointCloud points, PointCloud unpacked, double step_m) {
  ASSERT_EQ(points.size(), unpacked.size());
  const auto by_colour = [](const SurfacePoint& a, const SurfacePoint& b) {
    return std::tuple(a.rgb, a.sigma_m) < std::tuple(b.rgb, b.sigma_m);
  };
  std::ranges::sort(points, by_colour);
  std::ranges::sort(unpacked, by_colour);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].rgb, unpacked[i].rgb);
    EXPECT_LT((points[i].x_in_world - unpacked[i].x_in_world).cwiseAbs().maxCoeff(), 0.51 * step_m);
    EXPECT_NEAR(unpacked[i].sigma_m / points[i].sigma_m, 1.0, 0.03);
    // Half a code, and half an observation when that is made whole.
    EXPECT_NEAR(unpacked[i].observations, points[i].observations,
                (std::exp2(1.0 / 32.0) - 1.0) * points[i].observations + 0.5);
    EXPECT_NEAR(unpacked[i].grain_m / points[i].grain_m, 1.0, 1e-5);
  }
}

TEST(PointPlanesTest, ComeBackToATenthOfTheFinestGrain) {
  const PointCloud points = RandomPoints(3000, 2.0);
  const PackedPoints packed = PackPoints(points, 0.01);
  EXPECT_DOUBLE_EQ(packed.step_m, 0.001);
  ExpectSame(points, Unpack(packed), packed.step_m);
}

TEST(PointPlanesTest, OfKilometresComeBackToMillimetres) {
  const PointCloud points = RandomPoints(1000, 1500.0);
  const PackedPoints packed = PackPoints(points, 0.01);
  EXPECT_LT(packed.step_m, 0.002);
  ExpectSame(points, Unpack(packed), packed.step_m + 4e-4);  // and the float's own
}

TEST(PointPlanesTest, GoFromCoarseToFine) {
  const PackedPoints packed = PackPoints(RandomPoints(6400, 1.0), 0.01);
  ASSERT_EQ(packed.levels.size(), 3U);
  EXPECT_EQ(packed.levels[0].count, 100U);
  EXPECT_EQ(packed.levels[1].count, 700U);
  EXPECT_EQ(packed.levels[2].count, 5600U);
  const Json described = DescribePoints(packed, 12800);
  EXPECT_EQ(described["levels"][1]["id"], "points-1");
  EXPECT_EQ(described["count_in_map"], 12800);
}

TEST(PointPlanesTest, FewOrNoPointsAreNoTrouble) {
  EXPECT_TRUE(PackPoints({}, 0.01).levels.empty());
  const PointCloud one = RandomPoints(1, 1.0);
  const PackedPoints packed = PackPoints(one, 0.0);
  ASSERT_EQ(packed.levels.size(), 1U);
  EXPECT_GT(packed.step_m, 0.0);
}

}  // namespace
}  // namespace rigmap
