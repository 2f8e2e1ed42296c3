#include "georeference/route_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace rigmap {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// East along the equator's parallel, one metre a pose.
Trajectory EastwardPoses(int count) {
  Trajectory trajectory(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    trajectory[i].stamp_ns = 1448551416619000000 + i;
    trajectory[i].world_from_left.translation = {static_cast<double>(i), 0.0, 0.0};
    trajectory[i].position_covariance = Eigen::Vector3d(1e-4, 4e-4, 9e-4).asDiagonal();
    trajectory[i].source = PoseSource::kAdjusted;
  }
  return trajectory;
}

EarthFrame FrameAt(double latitude_deg, double longitude_deg, double angle_rad = 0.0) {
  const Geodetic origin{latitude_deg, longitude_deg, 6.0};
  return {origin, angle_rad, Eigen::Vector3d::Zero(), UtmZoneOf(origin)};
}

TEST(RouteFiles, GeoJsonHoldsRoutePosesAndRocksInLongitudeLatitudeHeight) {
  const Trajectory trajectory = EastwardPoses(3);
  const EarthMap earth(FrameAt(52.21, 4.40));
  const std::vector<RouteLandmark> rocks{{{1.0, 2.0, 0.5}, 0.8, 0.4}};
  const json file = json::parse(WriteRouteGeoJson({trajectory, earth, rocks, 0.004, 0.003}));
  EXPECT_EQ(file["type"], "FeatureCollection");
  ASSERT_EQ(file["features"].size(), 5U);
  const json& line = file["features"][0];
  EXPECT_EQ(line["geometry"]["type"], "LineString");
  EXPECT_NEAR(line["geometry"]["coordinates"][0][0], 4.40, 1e-8);
  EXPECT_NEAR(line["geometry"]["coordinates"][0][1], 52.21, 1e-8);
  EXPECT_NEAR(line["geometry"]["coordinates"][0][2], 6.0, 1e-3);
  EXPECT_EQ(line["properties"]["position_sigma_m"], 0.004);
  EXPECT_FALSE(line["properties"].contains("verdict"));
  const json& pose = file["features"][2];
  EXPECT_EQ(pose["geometry"]["type"], "Point");
  EXPECT_EQ(pose["properties"]["stamp_ns"], 1448551416619000001);
  EXPECT_NEAR(pose["properties"]["sigma_east_m"], 0.01, 1e-6);
  EXPECT_NEAR(pose["properties"]["sigma_north_m"], 0.02, 1e-6);
  EXPECT_NEAR(pose["properties"]["sigma_up_m"], 0.03, 1e-6);
}

TEST(RouteFiles, GeoJsonLeavesOutSigmasThatNobodyKnows) {
  Trajectory trajectory = EastwardPoses(2);
  trajectory[1].position_covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const json file =
      json::parse(WriteRouteGeoJson({trajectory, EarthMap(FrameAt(52.21, 4.40)), {}}));
  EXPECT_TRUE(file["features"][1]["properties"].contains("sigma_up_m"));
  EXPECT_FALSE(file["features"][2]["properties"].contains("sigma_up_m"));
}

// RFC 7946, 3.1.6: closed, the outer ring counterclockwise.
TEST(RouteFiles, RocksAreClosedRingsCounterclockwise) {
  const EarthMap earth(FrameAt(-30.0, 100.0));
  const Trajectory trajectory = EastwardPoses(2);
  const std::vector<RouteLandmark> rocks{{{1.0, 2.0, 0.5}, 0.8, 0.4}};
  const json file = json::parse(WriteRouteGeoJson({trajectory, earth, rocks}));
  const json ring = file["features"].back()["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 17U);
  EXPECT_EQ(ring.front(), ring.back());
  double twice_area = 0.0;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    twice_area += ring[i][0].get<double>() * ring[i + 1][1].get<double>() -
                  ring[i + 1][0].get<double>() * ring[i][1].get<double>();
  }
  EXPECT_GT(twice_area, 0.0);
}

TEST(RouteFiles, SigmasTurnWithTheWorld) {
  const Trajectory trajectory = EastwardPoses(2);
  const EarthMap earth(FrameAt(52.21, 3.0, 1.5707963267948966));  // x points north
  const json file = json::parse(WriteRouteGeoJson({trajectory, earth, {}}));
  EXPECT_NEAR(file["features"][1]["properties"]["sigma_north_m"], 0.01, 1e-6);
  EXPECT_NEAR(file["features"][1]["properties"]["sigma_east_m"], 0.02, 1e-6);
}

TEST(RouteFiles, ARouteAcrossTheAntimeridianIsCutThere) {
  const Trajectory trajectory = EastwardPoses(4);
  const EarthMap earth(FrameAt(0.0, 180.0 - 1.5 / 111319.49));
  const json geometry =
      json::parse(WriteRouteGeoJson({trajectory, earth, {}}))["features"][0]["geometry"];
  EXPECT_EQ(geometry["type"], "MultiLineString");
  ASSERT_EQ(geometry["coordinates"].size(), 2U);
  EXPECT_EQ(geometry["coordinates"][0].size(), 3U);
  EXPECT_EQ(geometry["coordinates"][0][2][0], 180.0);
  EXPECT_EQ(geometry["coordinates"][1][0][0], -180.0);
}

TEST(RouteFiles, UtmTrajectoryHoldsTheGridsCoordinatesAndAxes) {
  const Trajectory trajectory = EastwardPoses(2);
  const EarthMap earth(FrameAt(-30.0, 3.0));  // on the central meridian: the grid's north is north
  std::istringstream text(WriteTrajectoryUtm(trajectory, earth));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "stamp_ns,easting,northing,height,qx,qy,qz,qw,se,sn,sh,source");
  std::getline(text, line);
  EXPECT_THAT(line, testing::StartsWith("1448551416619000000,500000.0000,6681"));
  EXPECT_THAT(line, testing::EndsWith(",6.0000,0.000000000000,0.000000000000,0.000000000000,"
                                      "1.000000000000,0.01,0.02,0.03,adjusted"));
}

TEST(RouteFiles, KmlLiesOnTheGroundAndBearsTheWarning) {
  const Trajectory trajectory = EastwardPoses(2);
  const EarthMap earth(FrameAt(52.21, 4.40));
  const std::vector<RouteLandmark> rocks{{{1.0, 2.0, 0.5}, 0.8, 0.4}};
  const std::string kml = WriteRouteKml({trajectory, earth, rocks, 0.0, 0.0, "not trusted: a < b"});
  EXPECT_THAT(kml, HasSubstr("<coordinates>4.400000000,52.210000000 4.4000"));
  EXPECT_THAT(kml, HasSubstr("<tessellate>1</tessellate>"));
  EXPECT_THAT(kml, HasSubstr("not trusted: a &lt; b"));
  EXPECT_THAT(kml, HasSubstr("0.80 m wide, 0.40 m high"));
  EXPECT_THAT(kml, testing::Not(HasSubstr("altitudeMode")));
}

}  // namespace
}  // namespace rigmap
