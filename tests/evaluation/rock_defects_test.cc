// A plain truth scores the floor of each figure; planted defects are read with their size.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "evaluation/rock_metrics.h"
#include "tests/evaluation/synthetic_beach.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

const Eigen::Vector3f kView(0.0F, 1.0F, 0.0F);

class RockDefects : public testing::Test {
 protected:
  Points Noisy(Points points) {
    for (auto& x : points) x += random_.Noise(0.001).cast<float>();
    return points;
  }
  // The map of the true sand and of another rock.
  RockMetrics Judge(const Points& rock) { return OnlyRock(Noisy(Together(sand_, rock)), truth_); }
  template <class Condition>
  Points RockWithout(const Condition& condition) const {
    Points rest = rock_;
    std::erase_if(rest, condition);
    return rest;
  }

  SeededRandom random_;
  MapTruth truth_ = MakeBeach({kDome});
  Points rock_ = PointsOfKind(truth_, true), sand_ = PointsOfKind(truth_, false);
};

TEST_F(RockDefects, AreNotFoundInTheTruth) {
  const RockMetrics rock = Judge(rock_);
  EXPECT_EQ(rock.visible_points, rock_.size());
  EXPECT_NEAR(rock.from_path_m, 1.5, 1e-9);
  EXPECT_EQ(rock.completeness, 1.0);
  EXPECT_TRUE(rock.Found());
  EXPECT_EQ(rock.shift.value().directions, 3);
  EXPECT_LT(rock.shift->along_axes_m.norm(), 0.0004);
  EXPECT_LT(rock.shift->sigma_m.maxCoeff(), 0.0005);
  EXPECT_LT((rock.stretch.value().along_axes - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(),
            0.004);
  EXPECT_LT(rock.stretch->sigma.maxCoeff(), 0.02);  // so that all count
  EXPECT_LT(rock.stretch->rms_m, 0.0005);
  EXPECT_EQ(rock.stretch->doubled_share, 0.0);
  EXPECT_NEAR(rock.top_m.value(), 0.0, 0.001);
  EXPECT_EQ(rock.ghosts.value().over_3cm_share, 0.0);
}

TEST_F(RockDefects, AreFoundInAShiftAndTheirDirectionWithThem) {
  const RockMetrics rock = Judge(Displaced(rock_, {0.012F, 0.016F, 0.0F}));
  EXPECT_EQ(rock.shift.value().directions, 3);
  EXPECT_NEAR(rock.shift->along_axes_m.x(), 0.016, 0.001);   // along the view
  EXPECT_NEAR(rock.shift->along_axes_m.y(), -0.012, 0.001);  // to its left
  EXPECT_NEAR(rock.shift->along_axes_m.z(), 0.0, 0.001);
  EXPECT_NEAR(rock.top_m.value(), 0.0, 0.001);  // the shift undone
}

TEST_F(RockDefects, AreFoundInAStretchAlongTheView) {
  Points longer = rock_;
  for (auto& x : longer) x.y() = 1.5F + 1.08F * (x.y() - 1.5F);
  const RockStretch stretch = Judge(longer).stretch.value();
  EXPECT_NEAR(stretch.along_axes.x(), 1.08, 0.008);
  EXPECT_NEAR(stretch.along_axes.y(), 1.00, 0.008);
  EXPECT_NEAR(stretch.along_axes.z(), 1.00, 0.008);
  EXPECT_LT(stretch.sigma.maxCoeff(), 0.02);
}

TEST_F(RockDefects, AreFoundInAStretchAcrossAndUp) {
  Points other = rock_;
  for (auto& x : other) {
    x.x() = 1.0F + 0.95F * (x.x() - 1.0F);
    x.z() *= 1.06F;
  }
  const RockMetrics rock = Judge(other);
  EXPECT_NEAR(rock.stretch.value().along_axes.x(), 1.00, 0.008);
  EXPECT_NEAR(rock.stretch->along_axes.y(), 0.95, 0.008);
  EXPECT_NEAR(rock.stretch->along_axes.z(), 1.06, 0.008);
  EXPECT_NEAR(rock.top_m.value(), 0.06 * 0.25, 0.001);
}

TEST_F(RockDefects, AreFoundInATopThatIsRemovedOrFlattened) {
  const auto removed = RockWithout([](const auto& x) { return x.z() > 0.22F; });
  EXPECT_NEAR(Judge(removed).top_m.value(), -0.03, 0.0045);
  Points flat = rock_;
  for (auto& x : flat) x.z() = std::min(x.z(), 0.22F);
  EXPECT_NEAR(Judge(flat).top_m.value(), -0.03, 0.003);
}

// A top seen from below cannot be judged.
TEST_F(RockDefects, AreNotSoughtOnAHiddenTop) {
  for (std::size_t i = 0; i < truth_.surface.size(); ++i) {
    if (truth_.surface.x_in_truth[i].z() > 0.2F) truth_.surface.visible[i] = 0;
  }
  const RockMetrics rock = Judge(rock_);
  EXPECT_TRUE(rock.Found());
  EXPECT_FALSE(rock.top_m);
}

TEST_F(RockDefects, AreFoundInPointsBehindTheRock) {
  const auto over_sand = static_cast<double>(
      std::count_if(rock_.begin(), rock_.end(), [](const auto& x) { return x.z() > 0.05F; }));
  Points ghosts, smear;
  for (int i = 0; i < std::lround(over_sand / 19.0); ++i) {
    const float height = static_cast<float>(random_.Uniform(0.12, 0.24));
    const float aside = static_cast<float>(random_.Uniform(-0.1, 0.1));
    ghosts.emplace_back(1.0F + aside, 1.8F, height);
    const Eigen::Vector3f out = Eigen::Vector3f(aside, 0.1F, height).normalized();
    smear.push_back(Eigen::Vector3f(1.0F, 1.5F, 0.0F) + 0.285F * out);  // 3.5 cm from the rock
  }
  const RockGhosts far = Judge(Together(rock_, ghosts)).ghosts.value();
  EXPECT_NEAR(far.over_3cm_share, 0.05, 0.002);
  EXPECT_NEAR(far.over_4cm_share, 0.05, 0.002);
  const RockGhosts near = Judge(Together(rock_, smear)).ghosts.value();
  EXPECT_NEAR(near.over_3cm_share, 0.05, 0.003);
  EXPECT_LT(near.over_4cm_share, 0.002);
}

// Only what faces the viewer, or turns its back on them, parts by a centimetre.
TEST_F(RockDefects, AreFoundInASecondSheet) {
  const RockMetrics rock = Judge(Together(rock_, Displaced(rock_, -0.025F * kView)));
  EXPECT_GT(rock.stretch.value().doubled_share, 0.3);
  EXPECT_LT(rock.stretch->doubled_share, 0.9);
  EXPECT_EQ(rock.completeness, 1.0);
}

// Sand that is too high, or that buries the foot, is not the rock's error.
TEST_F(RockDefects, AreNotFoundInTheSand) {
  sand_ = Displaced(sand_, {0.0F, 0.0F, 0.03F});
  const RockMetrics rock = Judge(rock_);
  EXPECT_LT(rock.shift.value().along_axes_m.norm(), 0.001);
  EXPECT_LT((rock.stretch.value().along_axes - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(),
            0.01);
}

// Half a rock in its position, half of it shifted: a compromise, however densely either is mapped.
TEST_F(RockDefects, DoNotDependOnHowManyPointsShowThem) {
  Points once, dense;
  for (const auto& x : rock_) {
    const bool front = x.y() < 1.5F;
    once.push_back(front ? x : Eigen::Vector3f(x + 0.008F * kView));
    dense.insert(dense.end(), front ? 10 : 1, once.back());
  }
  const double shift_m = Judge(once).shift.value().along_axes_m.x();
  EXPECT_NEAR(shift_m, 0.004, 0.0015);
  EXPECT_NEAR(Judge(dense).shift.value().along_axes_m.x(), shift_m, 0.0004);
}

// A cap all of which faces up tells its height and nothing else.
TEST_F(RockDefects, CountOnlyAlongWhatTheRockFaces) {
  truth_ = MakeBeach({{{1.0, 2.0}, 1.0}});
  for (std::size_t i = 0; i < truth_.surface.size(); ++i) {
    truth_.surface.visible[i] = truth_.surface.normal[i].z() > 0.98F ? 1 : 0;
  }
  const Points all = PointsOfKind(truth_, true);
  const RockShift shift = OnlyRock(Displaced(all, {0.0F, 0.0F, 0.01F}), truth_).shift.value();
  EXPECT_EQ(shift.directions, 1);
  EXPECT_NEAR(shift.along_axes_m.norm(), 0.01, 0.0005);
}

// Errors that neighbouring patches share two by two, as those of a stereo map.
TEST_F(RockDefects, HaveTheSigmasThatTheirScatterShows) {
  constexpr int kTrials = 60;
  double squared_off = 0.0, variance = 0.0, squared_shift = 0.0, shift_variance = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::map<std::array<int, 3>, float> error_m;
    Points map;
    for (const auto& x : rock_) {
      const auto cell = [&](float size_m, int axis) {
        return static_cast<int>(std::floor(x(axis) / size_m));
      };
      const auto [at, is_new] =
          error_m.try_emplace({cell(0.05F, 0), cell(0.1F, 1), cell(0.05F, 2)});
      if (is_new) at->second = static_cast<float>(random_.Normal(0.004));
      const Eigen::Vector3f normal = (x - Eigen::Vector3f(1.0F, 1.5F, 0.0F)).normalized();
      map.push_back(x + at->second * normal);
    }
    const RockMetrics rock = OnlyRock(map, truth_);
    squared_off += (rock.stretch.value().along_axes - Eigen::Vector3d::Ones()).squaredNorm();
    variance += rock.stretch->sigma.squaredNorm();
    squared_shift += rock.shift.value().along_axes_m.squaredNorm();
    shift_variance += rock.shift->sigma_m.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squared_off / variance), 1.0, 0.3);
  EXPECT_NEAR(std::sqrt(squared_shift / shift_variance), 1.0, 0.3);
}

}  // namespace
}  // namespace rigmap
