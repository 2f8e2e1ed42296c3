#include "workflows/plan_remarks.h"

#include <gmock/gmock.h>

#include "georeference/local_frame.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr StampNs kSecond_ns = 1'000'000'000;

std::vector<StampNs> EverySecond(int count) {
  std::vector<StampNs> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(i * kSecond_ns);
  return stamps;
}

TEST(RemarksOnStampsTest, NamePairsThatFollowTooCloselyAndNoOthers) {
  std::vector<StampNs> stamps = EverySecond(10);
  EXPECT_THAT(RemarksOnStamps(stamps), IsEmpty());
  stamps.insert(stamps.begin() + 4, stamps[3] + kSecond_ns / 4);  // early, but no repetition
  EXPECT_THAT(RemarksOnStamps(stamps), IsEmpty());
  stamps.insert(stamps.begin() + 8, stamps[7] + kSecond_ns / 1000);
  EXPECT_THAT(
      RemarksOnStamps(stamps),
      ElementsAre(HasSubstr("1 of 12 pairs are closer to the one before than a fifth of the "
                            "usual 1 s, the first of them pair 8, 0.001 s after")));
  EXPECT_THAT(RemarksOnStamps({}), IsEmpty());
}

// Along the north at `speed`, a fix a second, of 5 mm.
std::vector<GnssFix> DrivenNorth(int count, double speed) {
  const LocalFrame plane({52.2, 4.4, 3.0});
  std::vector<GnssFix> fixes;
  for (int i = 0; i < count; ++i) {
    // Scattered by as much as is stated.
    const Geodetic position = plane.ToGeodetic({0.005 * (i % 3 - 1), speed * i, 0.0});
    fixes.push_back({i * kSecond_ns,
                     std::string(kRtkFixed),
                     position.latitude_deg,
                     position.longitude_deg,
                     position.altitude_m,
                     {0.005, 0.005, 0.01}});
  }
  return fixes;
}

TEST(RemarksOnFixesTest, NameAJumpAndNoDrive) {
  constexpr double kFiveMetres_deg = 5.0 / 111e3;
  for (const double speed : {0.0, 0.3}) {
    std::vector<GnssFix> fixes = DrivenNorth(40, speed);
    EXPECT_THAT(RemarksOnFixes(fixes), IsEmpty()) << speed;
    for (std::size_t i = 20; i < 30; ++i) fixes[i].latitude_deg += kFiveMetres_deg;
    EXPECT_THAT(RemarksOnFixes(fixes),
                ElementsAre(testing::AllOf(HasSubstr("2 of 39 steps between RTK fixes"),
                                           HasSubstr("after the fix at 19.000 s"))))
        << speed;
    // What is not fixed is no fix to jump.
    for (std::size_t i = 20; i < 30; ++i) fixes[i].status = "RTK_FLOAT";
    EXPECT_THAT(RemarksOnFixes(fixes), IsEmpty()) << speed;
  }
}

TEST(RemarkOnNeighboursTest, TellsPartsThatOverlapOrLieApart) {
  const PartSpan earlier{"1", 10.0, 50.0};
  EXPECT_EQ(RemarkOnNeighbours(earlier, {"2", 52.0, 90.0}, 2.5), "");
  EXPECT_THAT(RemarkOnNeighbours(earlier, {"2", 152.0, 190.0}, 2.5),
              HasSubstr("begins 102 s after part 1 ends"));
  EXPECT_THAT(RemarkOnNeighbours(earlier, {"2", 10.0, 50.0}, 2.5),
              HasSubstr("begins 40 s before part 1 ends"));
}

}  // namespace
}  // namespace rigmap
