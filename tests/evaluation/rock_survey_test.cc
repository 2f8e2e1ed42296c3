#include "evaluation/rock_survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "georeference/local_frame.h"
#include "georeference/utm_grid.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

// A rover that drove ten metres along x over level ground, 1.1 m below its camera.
class RockSurveyTest : public testing::Test {
 protected:
  RockSurveyTest() {
    for (int i = 0; i <= 25; ++i) {
      TimedPose pose;
      pose.stamp_ns = i * StampNs{400'000'000};
      pose.world_from_left = RoverPose(0.4 * i, 0.0, 0.0);
      trajectory_.push_back(pose);
    }
    PointCloud cloud;
    for (double x_m = 0.0; x_m < 14.0; x_m += 0.05) {
      for (double y_m = -4.0; y_m < 4.0; y_m += 0.05) {
        cloud.push_back({.x_in_world = Eigen::Vector3d(x_m, y_m, -1.1).cast<float>()});
      }
    }
    HeightGrid grid;
    grid.Add(cloud);
    map_.ground = GroundLevel(grid);
    alignment_.plane_origin = {52.2141, 4.4004, 6.0};
    alignment_.plane_from_world = {1.2, {20.0, -10.0}};
    alignment_.covariance.diagonal() << 1e-4, 1e-4, 1e-6;
  }

  SurveyedLandmark Survey(const std::string& kind, const Eigen::Vector2d& x_in_world) const {
    const LocalFrame plane(alignment_.plane_origin);
    const Eigen::Vector2d position = alignment_.plane_from_world * x_in_world;
    const Geodetic geodetic = plane.ToGeodetic({position.x(), position.y(), 0.0});
    const UtmZone zone = UtmZoneOf(geodetic);
    const UtmPoint utm = ToUtm(zone, geodetic);
    return {kind, {zone.Epsg(), utm.easting_m, utm.northing_m}};
  }

  void AddRock(const Eigen::Vector2d& x_in_world) {
    map_.rocks.push_back({.centre = x_in_world, .width_m = 0.5, .height_m = 0.3, .points = 900});
  }

  RockSurvey Compare(const std::vector<SurveyedLandmark>& surveyed,
                     const RockSurveyOptions& options = {}) const {
    return CompareWithSurvey(map_, {trajectory_, rig_}, {surveyed, alignment_}, options);
  }

  StereoRig rig_ = LocCamRig();
  Trajectory trajectory_;
  RockSegmentation map_{.rocks = {}, .ground = GroundLevel(HeightGrid())};
  RtkAlignment alignment_;
};

// The same rocks in Chile, zone 19 south.
TEST_F(RockSurveyTest, TakesPositionsOfAnyUtmZone) {
  alignment_.plane_origin = {-23.02, -67.75, 2400.0};
  const Eigen::Vector2d position(7.0, 1.0);
  AddRock(position + Eigen::Vector2d(0.03, -0.04));
  const SurveyedLandmark rock = Survey("small", position);
  EXPECT_EQ(rock.position.epsg, 32719);
  const RockSurvey survey = Compare({rock});
  ASSERT_EQ(survey.rows.size(), 1U);
  ASSERT_TRUE(survey.rows[0].found);
  EXPECT_NEAR(survey.rows[0].offset_m.norm(), 0.05, 1e-3);
  EXPECT_LT((survey.rows[0].position_in_world - position).norm(), 1e-3);
}

TEST_F(RockSurveyTest, TellsHowFarARockIsFromItsSurveyedPosition) {
  SeededRandom random;
  for (int run = 0; run < 20; ++run) {
    map_.rocks.clear();
    alignment_.plane_from_world = {random.Uniform(-3.0, 3.0), random.Vector(30.0).head<2>()};
    const Eigen::Vector2d position(random.Uniform(5.0, 9.0), random.Uniform(-1.2, 1.2));
    const Eigen::Vector2d off = random.Vector(0.14).head<2>();
    AddRock(position + off);
    const RockSurvey survey = Compare({Survey("small", position)});
    ASSERT_EQ(survey.rows.size(), 1U);
    EXPECT_EQ(survey.found, 1);
    EXPECT_EQ(survey.unknown, 0);
    ASSERT_TRUE(survey.rows[0].found);
    EXPECT_EQ(survey.rows[0].found->height_m, 0.3);
    const Rigid2 turn{alignment_.plane_from_world.angle_rad, Eigen::Vector2d::Zero()};
    EXPECT_LT((survey.rows[0].offset_m - turn * off).norm(), 1e-4);  // m
  }
}

TEST_F(RockSurveyTest, LooksWithinHalfAWidthAndTheSigmas) {
  const Eigen::Vector2d position(6.0, 0.5);
  AddRock(position + Eigen::Vector2d(0.0, 0.45));
  EXPECT_EQ(Compare({Survey("small", position)}).found, 0);
  EXPECT_EQ(Compare({Survey("small", position)}).unknown, 1);
  EXPECT_EQ(Compare({Survey("medium", position)}).found, 1);
  EXPECT_NEAR(Compare({Survey("medium", position)}).rows[0].limit_m,
              0.4 + 3.0 * std::sqrt(0.03 * 0.03 + 1e-4 + 0.5e-6 * position.squaredNorm()), 1e-5);
  alignment_.unknown_clock_sigma_m = 0.15;
  EXPECT_EQ(Compare({Survey("small", position)}).found, 1);
}

TEST_F(RockSurveyTest, MatchesOneToOneNearestFirst) {
  const Eigen::Vector2d position(6.0, 0.5);
  const std::vector<SurveyedLandmark> two{Survey("small", position + Eigen::Vector2d(0.2, 0.0)),
                                          Survey("small", position + Eigen::Vector2d(0.0, 0.05))};
  AddRock(position);
  RockSurvey survey = Compare(two);
  ASSERT_EQ(survey.rows.size(), 2U);
  EXPECT_FALSE(survey.rows[0].found);
  EXPECT_TRUE(survey.rows[1].found);
  AddRock(position + Eigen::Vector2d(0.3, 0.0));
  survey = Compare(two);
  EXPECT_EQ(survey.found, 2);
  EXPECT_NEAR(survey.rows[0].offset_m.norm(), 0.1, 1e-4);
  EXPECT_NEAR(survey.rows[1].offset_m.norm(), 0.05, 1e-4);
}

TEST_F(RockSurveyTest, CountsOnlyRocksThatTheMapShouldShow) {
  const auto counts = [&](double x_m, double y_m) {
    return Compare({Survey("small", {x_m, y_m})}).rows.size();
  };
  EXPECT_EQ(counts(5.0, 0.0), 1U);
  EXPECT_EQ(counts(7.0, 2.5), 1U);
  EXPECT_EQ(counts(12.5, 0.0), 1U);  // ahead of the last pose
  EXPECT_EQ(counts(13.8, 0.0), 0U);  // more than 3.5 m from the path
  EXPECT_EQ(counts(7.0, 3.8), 0U);   // the same, aside
  EXPECT_EQ(counts(-1.0, 0.0), 0U);  // behind the camera
  EXPECT_EQ(counts(0.5, 1.5), 0U);   // beside it, never in view
  RockSurveyOptions near;
  near.max_view_m = 2.0;
  EXPECT_TRUE(Compare({Survey("small", {7.0, 1.8})}, near).rows.empty());
  trajectory_.resize(1);
  EXPECT_EQ(counts(3.0, 0.0), 0U);  // one frame is not enough
}

// One that the map cannot fully show still takes its rock, which is not unknown then.
TEST_F(RockSurveyTest, RocksOutOfCountTakePart) {
  const Eigen::Vector2d position(13.8, 0.0);
  AddRock(position);
  const RockSurvey survey = Compare({Survey("small", position)});
  EXPECT_TRUE(survey.rows.empty());
  EXPECT_EQ(survey.segmented, 1);
  EXPECT_EQ(survey.unknown, 0);
}

TEST_F(RockSurveyTest, PrintsATableAndTheSameNumbersAsJson) {
  AddRock({6.0, 0.5});
  AddRock({8.0, -3.0});
  const RockSurvey survey = Compare({Survey("medium", {6.1, 0.5}), Survey("large", {7.0, -1.0})});
  const auto json = ToJson(survey);
  EXPECT_EQ(json["expected"], 2);
  EXPECT_EQ(json["found"], 1);
  EXPECT_EQ(json["segmented"], 2);
  EXPECT_EQ(json["unknown"], 1);
  ASSERT_EQ(json["each"].size(), 2U);
  EXPECT_EQ(json["each"][0]["size"], "medium");
  EXPECT_EQ(json["each"][0]["distance_m"], 0.1);
  EXPECT_EQ(json["each"][0]["height_m"], 0.3);
  EXPECT_EQ(json["each"][1]["found"], false);
  EXPECT_FALSE(json["each"][1].contains("distance_m"));
  const std::string table = FormatTable(survey);
  EXPECT_THAT(table, HasSubstr("medium"));
  EXPECT_THAT(table, HasSubstr("0.10   0.30  0.50"));
  EXPECT_THAT(table, HasSubstr("1 of 2 surveyed rocks found; 2 in the map, 1 of them unknown"));
}

TEST_F(RockSurveyTest, JsonSaysWhetherTheClockIsDetermined) {
  EXPECT_EQ(ToJson(alignment_)["clock_offset_determined"], false);
  EXPECT_FALSE(ToJson(alignment_).contains("clock_offset_sigma_s"));
  alignment_.clock_offset_s = 0.4;
  alignment_.clock_offset_sigma_s = 0.03;
  EXPECT_EQ(ToJson(alignment_)["clock_offset_s"], 0.4);
  EXPECT_EQ(ToJson(alignment_)["clock_offset_sigma_s"], 0.03);
}

TEST_F(RockSurveyTest, EmptyMapsAndSurveysHaveNoRows) {
  EXPECT_TRUE(Compare({}).rows.empty());
  map_.ground = GroundLevel(HeightGrid());
  EXPECT_TRUE(Compare({Survey("small", {6.0, 0.5})}).rows.empty());
}

TEST_F(RockSurveyTest, RefusesPositionsOnAnotherGrid) {
  SurveyedLandmark rock = Survey("small", {6.0, 0.5});
  rock.position.epsg = 28992;
  EXPECT_THROW(Compare({rock}), DataError);
}

TEST_F(RockSurveyTest, RefusesOptionsOutOfRange) {
  RockSurveyOptions options;
  options.large_half_width_m = 0.0;
  EXPECT_THROW(Compare({}, options), UsageError);
}

}  // namespace
}  // namespace rigmap
