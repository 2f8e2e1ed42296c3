#include "matching/reference_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kNoise_px = 0.25;

class ReferencePatchesTest : public testing::Test {
 protected:
  Eigen::Vector2d TruePixel(int frame, int feature) const {
    const Eigen::Vector3d& x = rover_.points[rover_.point_of_feature[frame][feature]];
    return *Project(rover_.rig.left.camera, rover_.world_from_left[frame].Inverse() * x);
  }
  double Depth(int frame, int feature) const {
    const Eigen::Vector3d& x = rover_.points[rover_.point_of_feature[frame][feature]];
    return (rover_.world_from_left[frame].Inverse() * x).z();
  }
  double Growth(int frame_a, int a, int frame_b, int b) const {
    return Depth(frame_a, a) / Depth(frame_b, b);
  }
  // How far the refined position in b is from the spot of ground that a's feature as found shows.
  double Mismatch_px(int frame_a, int a, int frame_b, int b, const FeatureRefinement& later) const {
    const Eigen::Vector2d off_a = rover_.frames[frame_a].features[a].left - TruePixel(frame_a, a);
    const Eigen::Vector2d off_b = later.refined[b].left - TruePixel(frame_b, b);
    return (off_b - Growth(frame_a, a, frame_b, b) * off_a).norm();
  }

  SyntheticRover rover_ = MakeSyntheticRover({.frames = 3,
                                              .step_m = 0.25,
                                              .points_per_m2 = 12.0,
                                              .pixel_sigma = kNoise_px,
                                              .textured_patches = true});
  MatchingOptions options_;
};

ExpectedView Grown(double factor) { return {factor * Eigen::Matrix2d::Identity()}; }

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

TEST_F(ReferencePatchesTest, EveryFeatureStartsAsItsOwnReference) {
  const FeatureRefinement frame = StartRefinement(rover_.frames[0]);
  ASSERT_EQ(frame.references.size(), frame.found.features.size());
  for (std::size_t i = 0; i < frame.references.size(); ++i) {
    EXPECT_FALSE(frame.aligned[i]);
    EXPECT_EQ(frame.references[i].patch, frame.found.patches[i]);
    EXPECT_EQ(frame.refined[i].left, frame.found.features[i].left);
    EXPECT_LE(frame.references[i].offset.cwiseAbs().maxCoeff(), 0.5);
  }
}

TEST_F(ReferencePatchesTest, AlignedFeaturesMeanTheSameSpot) {
  const FeatureRefinement earlier = StartRefinement(rover_.frames[0]);
  FeatureRefinement later = StartRefinement(rover_.frames[1]);
  std::vector<double> before_px, after_px;
  int tried = 0;
  for (const auto& [a, b] : TrueMatches(rover_, 0, 1)) {
    ++tried;
    const Feature found = later.refined[b];
    const double before = Mismatch_px(0, a, 1, b, later);
    if (!AlignWithReference(earlier, a, later, b, Grown(Growth(0, a, 1, b)), options_)) continue;
    EXPECT_TRUE(later.aligned[b]);
    before_px.push_back(before);
    after_px.push_back(Mismatch_px(0, a, 1, b, later));
    // The stereo match went along.
    ASSERT_EQ(later.refined[b].right.has_value(), found.right.has_value());
    if (!found.right) continue;
    const Eigen::Vector2d moved = later.refined[b].left - found.left;
    EXPECT_LT((*later.refined[b].right - *found.right - moved).norm(), 1e-9);
  }
  EXPECT_GT(after_px.size(), 0.85 * tried);
  EXPECT_GT(Median(before_px), 0.3);
  EXPECT_LT(Median(after_px), 0.03);
}

// The patch of a view in which all that lies five pixels and more from its middle row, or column,
// has moved by two along it.
Patch TornPatch(const Patch& patch, bool by_rows) {
  Patch torn = patch;
  for (int across = 0; across < kPatchSize; ++across) {
    if (std::abs(across - kPatchRadius) < 5) continue;
    for (int along = 0; along + 2 < kPatchSize; ++along) {
      const auto at = [&](int i) {
        return by_rows ? across * kPatchSize + i : i * kPatchSize + across;
      };
      torn[at(along)] = patch[at(along + 2)];
    }
  }
  return torn;
}

TEST_F(ReferencePatchesTest, WindowsKeepToWhatIsOfAboutOneDepth) {
  const FeatureRefinement earlier = StartRefinement(rover_.frames[0]);
  const int count = static_cast<int>(earlier.refined.size());
  for (const bool by_rows : {true, false}) {
    const auto count_kept = [&](const Eigen::Array2d& depth_change) {
      FeatureRefinement later = StartRefinement(rover_.frames[0]);
      int kept = 0;
      for (int i = 0; i < count; ++i) {
        later.found.patches[i] = TornPatch(later.found.patches[i], by_rows);
        ExpectedView expected = Grown(1.0);
        expected.depth_change = depth_change;
        if (!AlignWithReference(earlier, i, later, i, expected, options_)) continue;
        if ((later.refined[i].left - later.found.features[i].left).norm() < 0.01) ++kept;
      }
      return kept;
    };
    const Eigen::Array2d across = by_rows ? Eigen::Array2d(0.0, 0.05) : Eigen::Array2d(0.05, 0.0);
    EXPECT_GT(count_kept(across), 0.9 * count);
    EXPECT_LT(count_kept(Eigen::Array2d::Zero()), 0.2 * count);
    EXPECT_LT(count_kept(across.reverse()), 0.2 * count);
  }
}

TEST_F(ReferencePatchesTest, ReferencesAreHandedOn) {
  const FeatureRefinement first = StartRefinement(rover_.frames[0]);
  FeatureRefinement second = StartRefinement(rover_.frames[1]),
                    third = StartRefinement(rover_.frames[2]);
  std::vector<int> first_of_second(second.refined.size(), -1);
  for (const auto& [a, b] : TrueMatches(rover_, 0, 1)) {
    if (AlignWithReference(first, a, second, b, Grown(Growth(0, a, 1, b)), options_))
      first_of_second[b] = a;
  }
  std::vector<double> mismatches_px;
  for (const auto& [b, c] : TrueMatches(rover_, 1, 2)) {
    const int a = first_of_second[b];
    if (a < 0 || !AlignWithReference(second, b, third, c, Grown(Growth(1, b, 2, c)), options_))
      continue;
    mismatches_px.push_back(Mismatch_px(0, a, 2, c, third));
    EXPECT_EQ(third.references[c].patch, first.found.patches[a]);
  }
  EXPECT_GT(mismatches_px.size(), 60u);
  EXPECT_LT(Median(mismatches_px), 0.03);
}

TEST_F(ReferencePatchesTest, PatchesThatGrewByThreeQuartersAreAligned) {
  rover_ = MakeSyntheticRover(
      {.points_per_m2 = 24.0, .pixel_sigma = kNoise_px, .textured_patches = true},
      {RoverPose(0.0, 0.0, 0.0), RoverPose(0.8, 0.0, 0.0)});
  const FeatureRefinement earlier = StartRefinement(rover_.frames[0]);
  FeatureRefinement later = StartRefinement(rover_.frames[1]);
  int tried = 0;
  std::vector<double> after_px;
  for (const auto& [a, b] : TrueMatches(rover_, 0, 1)) {
    const double growth = Growth(0, a, 1, b);
    if (growth < 1.4 || growth > 1.75) continue;
    ++tried;
    if (!AlignWithReference(earlier, a, later, b, Grown(growth), options_)) continue;
    after_px.push_back(Mismatch_px(0, a, 1, b, later));
  }
  EXPECT_GT(tried, 20);
  EXPECT_GT(after_px.size(), 0.8 * tried);
  EXPECT_LT(Median(after_px), 0.05);
}

TEST_F(ReferencePatchesTest, PatchesThatDisagreeChangeNothing) {
  const FeatureRefinement earlier = StartRefinement(rover_.frames[0]);
  FeatureRefinement later = StartRefinement(rover_.frames[1]);
  int tried = 0, accepted = 0;
  for (std::size_t i = 0; i < 200; ++i) {
    const int a = static_cast<int>(i % earlier.refined.size());
    const int b = static_cast<int>((7 * i + 3) % later.refined.size());
    if (rover_.point_of_feature[0][a] == rover_.point_of_feature[1][b] || later.aligned[b])
      continue;
    ++tried;
    if (AlignWithReference(earlier, a, later, b, Grown(1.0), options_)) {
      ++accepted;
      continue;
    }
    EXPECT_EQ(later.refined[b].left, later.found.features[b].left);
    EXPECT_EQ(later.refined[b].right, later.found.features[b].right);
    EXPECT_EQ(later.references[b].patch, later.found.patches[b]);
    EXPECT_FALSE(later.aligned[b]);
  }
  EXPECT_GT(tried, 100);
  EXPECT_LE(accepted, tried / 50);
}

TEST_F(ReferencePatchesTest, AViewThatShrankByHalfBecomesTheReference) {
  // The same points from 2 m behind: the far ones keep their size, the near ones do not.
  rover_ = MakeSyntheticRover({.points_per_m2 = 12.0, .textured_patches = true},
                              {RoverPose(2.0, 0.0, 0.0), RoverPose(0.0, 0.0, 0.0)});
  const FeatureRefinement earlier = StartRefinement(rover_.frames[0]);
  FeatureRefinement later = StartRefinement(rover_.frames[1]);
  int renewed = 0, handed_on = 0;
  for (const auto& [a, b] : TrueMatches(rover_, 0, 1)) {
    const double growth = Growth(0, a, 1, b);
    if (!AlignWithReference(earlier, a, later, b, Grown(growth), options_)) continue;
    const bool anew = later.references[b].patch == later.found.patches[b];
    if (growth < 0.6) {
      EXPECT_TRUE(anew) << growth;
    }
    if (growth > 0.73) {
      EXPECT_FALSE(anew) << growth;
    }
    ++(anew ? renewed : handed_on);
    if (!anew) continue;
    // The new reference patch stands for the refined position.
    const Eigen::Vector2d& found = later.found.features[b].left;
    const Eigen::Vector2d centre(std::round(found.x()), std::round(found.y()));
    EXPECT_LT((centre + later.references[b].offset - later.refined[b].left).norm(), 1e-9);
    EXPECT_EQ(later.references[b].frame_from_patch, Eigen::Matrix2d::Identity());
  }
  EXPECT_GT(renewed, 3);
  EXPECT_GT(handed_on, 3);
}

}  // namespace
}  // namespace rigmap
