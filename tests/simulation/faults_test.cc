#include "simulation/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 60;
constexpr double kInterval_s = 0.5;
constexpr std::uint64_t kSeeds = 40;

FaultPlan Plan(const std::vector<std::string>& specs, std::uint64_t seed = 1) {
  return PlanFaults(specs, kFrames, seed, kInterval_s);
}

std::string ComplaintAbout(const std::vector<std::string>& specs) {
  try {
    Plan(specs);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "none";
}

template <class Holds>
std::vector<int> FramesThat(const FaultPlan& plan, Holds holds) {
  std::vector<int> found;
  for (int i = 0; i < std::ssize(plan.frames); ++i) {
    if (holds(plan.frames[i])) found.push_back(i);
  }
  return found;
}

std::vector<int> Dropped(const FaultPlan& plan) {
  return FramesThat(plan, [](const FrameFault& fault) { return fault.dropped; });
}

int Losses(const FrameFault& fault) {
  return fault.dropped + fault.lone.has_value() + fault.black + fault.truncated.has_value();
}

TEST(Faults, NoneAskedForGivesNone) {
  const FaultPlan plan = Plan({});
  ASSERT_EQ(plan.frames.size(), kFrames);
  for (const FrameFault& fault : plan.frames) EXPECT_EQ(fault, FrameFault());
  EXPECT_TRUE(plan.gps_outages.empty() && plan.slip_bursts.empty() && plan.persons.empty());
  EXPECT_EQ(Plan({"dropped=0", "black=0", "person=0", "slip=0", "shadow=0", "glare=0"}), plan);
}

TEST(Faults, CountedDroppedFramesFollowEachOtherAwayFromTheEnds) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto dropped = Dropped(Plan({"dropped=10"}, seed));
    ASSERT_EQ(dropped.size(), 10u);
    EXPECT_EQ(dropped.back() - dropped.front(), 9);
    EXPECT_GE(dropped.front(), 2);
    EXPECT_LT(dropped.back(), kFrames - 2);
  }
}

TEST(Faults, SeedChoosesTheFrames) {
  EXPECT_EQ(Plan({"dropped=5", "exposure=4", "slip=2"}, 7),
            Plan({"dropped=5", "exposure=4", "slip=2"}, 7));
  int different = 0;
  for (std::uint64_t seed = 1; seed < kSeeds; ++seed) {
    different += Dropped(Plan({"dropped=5"}, seed)) != Dropped(Plan({"dropped=5"}, 0));
  }
  EXPECT_GT(different, static_cast<int>(kSeeds) / 2);
}

TEST(Faults, OneFaultDoesNotMoveAnother) {
  const FaultPlan alone = Plan({"dropped=5", "slip=2"});
  const FaultPlan more = Plan({"dropped=5", "exposure=3", "person=1", "slip=2", "glare=0.2"});
  EXPECT_EQ(Dropped(alone), Dropped(more));
  EXPECT_EQ(alone.slip_bursts, more.slip_bursts);
}

TEST(Faults, RangeIsTakenExactly) {
  EXPECT_EQ(Dropped(Plan({"dropped=0:3"})), (std::vector{0, 1, 2}));
  const FaultPlan plan = Plan({"lone-left=5:7", "lone-right=7:8", "person=10:30", "gps-outage=1:9",
                               "slip=4:60", "shadow=58:60", "glare=2:4", "glare-area=0.5"});
  EXPECT_EQ(plan.frames[5].lone, Eye::kLeft);
  EXPECT_EQ(plan.frames[6].lone, Eye::kLeft);
  EXPECT_EQ(plan.frames[7].lone, Eye::kRight);
  EXPECT_EQ(plan.persons, (std::vector<FrameRange>{{10, 30}}));
  EXPECT_EQ(plan.gps_outages, (std::vector<FrameRange>{{1, 9}}));
  EXPECT_EQ(plan.slip_bursts, (std::vector<FrameRange>{{4, 60}}));
  EXPECT_EQ(FramesThat(plan, [](const auto& f) { return f.shadow; }), (std::vector{58, 59}));
  EXPECT_EQ(FramesThat(plan, [](const auto& f) { return f.glare_area == 0.5; }),
            (std::vector{2, 3}));
}

TEST(Faults, ImagesAreLostInOneWayAtATime) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const FaultPlan plan = Plan({"black=8", "lone-left=4", "truncated=9", "dropped=12",
                                 "lone-right=3", "dropped=20:24", "black=2"},
                                seed);
    int lost = 0;
    for (int i = 0; i < kFrames; ++i) {
      EXPECT_LE(Losses(plan.frames[i]), 1) << "frame " << i;
      lost += Losses(plan.frames[i]);
    }
    EXPECT_EQ(lost, 8 + 4 + 9 + 12 + 3 + 4 + 2);
    for (const int i : {0, 1, kFrames - 2, kFrames - 1}) EXPECT_EQ(Losses(plan.frames[i]), 0);
  }
}

TEST(Faults, TruncatedMeetsEitherEye) {
  const FaultPlan plan = Plan({"truncated=40"});
  const auto count = [&](Eye eye) {
    return FramesThat(plan, [&](const auto& fault) { return fault.truncated == eye; }).size();
  };
  EXPECT_EQ(count(Eye::kLeft) + count(Eye::kRight), 40u);
  EXPECT_GT(count(Eye::kLeft), 5u);
  EXPECT_GT(count(Eye::kRight), 5u);
}

TEST(Faults, ExposureChangesInSteps) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const FaultPlan plan = Plan({"exposure=6"}, seed);
    int steps = 0;
    for (int i = 1; i < kFrames; ++i) {
      const double gain = plan.frames[i].exposure_gain;
      EXPECT_GE(gain, 1.0 / 1.6);
      EXPECT_LE(gain, 1.6);
      const double ratio = std::abs(std::log(gain / plan.frames[i - 1].exposure_gain));
      steps += ratio > 0.0;
      if (ratio > 0.0) {
        EXPECT_GT(ratio, std::log(1.14)) << "frame " << i;
      }
    }
    EXPECT_EQ(steps, 6);
    EXPECT_EQ(plan.frames[1].exposure_gain, 1.0);
    EXPECT_NE(plan.frames[kFrames - 1].exposure_gain, 1.0);
  }
}

TEST(Faults, StretchesHaveTheirLengthsAndStayApart) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const FaultPlan plan = Plan({"person=3", "gps-outage=2", "slip=5"}, seed);
    const auto check = [](const std::vector<FrameRange>& ranges, std::size_t count, int length) {
      ASSERT_EQ(ranges.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(ranges[i].end - ranges[i].first, length);
        EXPECT_GE(ranges[i].first, i == 0 ? 2 : ranges[i - 1].end);
        EXPECT_LE(ranges[i].end, kFrames - 2);
      }
    };
    check(plan.persons, 3, 12);
    check(plan.gps_outages, 2, 20);  // 10 s
    check(plan.slip_bursts, 5, 6);   // 3 s
  }
}

TEST(Faults, StretchIsShortenedToAShortRun) {
  const std::vector<std::string> specs{"gps-outage=1"};
  const FaultPlan plan = PlanFaults(specs, 10, 1, kInterval_s);
  EXPECT_EQ(plan.gps_outages, (std::vector<FrameRange>{{2, 8}}));
}

TEST(Faults, GlareLiesInTheMiddle) {
  const FaultPlan plan = Plan({"glare=0.5"});
  const auto glaring = FramesThat(plan, [](const auto& fault) { return fault.glare_area == 0.3; });
  EXPECT_EQ(glaring.size(), 30u);
  EXPECT_EQ(glaring.front(), 15);
  EXPECT_EQ(glaring.back(), 44);
  EXPECT_EQ(FramesThat(Plan({"glare=1"}), [](const auto& f) { return f.glare_area > 0; }).size(),
            kFrames);
}

TEST(Faults, ComplainsInSentences) {
  EXPECT_THAT(ComplaintAbout({"fog=1"}), HasSubstr("dropped, lone-left"));
  EXPECT_THAT(ComplaintAbout({"fog=1"}), HasSubstr("found 'fog'"));
  EXPECT_THAT(ComplaintAbout({"dropped"}), HasSubstr("expected a count or a range"));
  EXPECT_THAT(ComplaintAbout({"dropped=-1"}), HasSubstr("found '-1'"));
  EXPECT_THAT(ComplaintAbout({"dropped=1.5"}), HasSubstr("found '1.5'"));
  EXPECT_THAT(ComplaintAbout({"dropped=57"}), HasSubstr("found 57"));
  EXPECT_THAT(ComplaintAbout({"black=57"}), HasSubstr("at most 56"));
  EXPECT_THAT(ComplaintAbout({"slip=50:61"}), HasSubstr("within the frames 0:60"));
  EXPECT_THAT(ComplaintAbout({"dropped=0:60"}), HasSubstr("at least one frame to be left"));
  EXPECT_THAT(ComplaintAbout({"slip=5:5"}), HasSubstr("found '5:5'"));
  EXPECT_THAT(ComplaintAbout({"slip=5:x"}), HasSubstr("found '5:x'"));
  EXPECT_THAT(ComplaintAbout({"glare=1.5"}), HasSubstr("a share from 0 to 1"));
  EXPECT_THAT(ComplaintAbout({"glare=nan"}), HasSubstr("a share from 0 to 1"));
  EXPECT_THAT(ComplaintAbout({"glare-area=0"}), HasSubstr("over 0"));
  EXPECT_THAT(ComplaintAbout({"shadow=2"}), HasSubstr("1 for the whole run"));
  EXPECT_THAT(ComplaintAbout({"person=5"}), HasSubstr("at most 4 of 12 frames"));
  EXPECT_THAT(ComplaintAbout({"dropped=3:9", "lone-left=8:10"}), HasSubstr("frame 8 is given to"));
}

TEST(Faults, HelpNamesEveryFault) {
  for (const char* name : {"dropped", "lone-left", "lone-right", "black", "truncated", "exposure",
                           "shadow", "person", "gps-outage", "slip", "glare ", "glare-area"}) {
    EXPECT_THAT(DescribeFaultNames(), HasSubstr(name));
  }
}

}  // namespace
}  // namespace rigmap
