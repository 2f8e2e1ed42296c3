// A rover that comes back to where it was, with an odometry that does not know it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adjustment/adjust.h"
#include "dataset/open_dataset.h"
#include "features/extract_features.h"
#include "geometry/alignment.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "pose_graph/relax_poses.h"
#include "tests/support/simulated_part.h"
#include "tests/support/temporary_folder.h"
#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

// Every step too long by this share and turned too far to the left by so much.
struct Drift {
  double share = 0.0;
  double turn_rad = 0.0;
};

Odometry Worsened(const Odometry& odometry, const Drift& drift) {
  Odometry worse = odometry;
  for (std::size_t i = 1; i < worse.size(); ++i) {
    Rigid3 step = odometry[i - 1].world_from_left.Inverse() * odometry[i].world_from_left;
    step.translation *= 1.0 + drift.share;
    step.rotation = step.rotation * ExpRotation({0.0, -drift.turn_rad, 0.0});
    worse[i].world_from_left = worse[i - 1].world_from_left * step;
  }
  return worse;
}

// A loop as far as its odometry: simulated, extracted and tracked once for all tests.
class LoopClosureTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const TemporaryFolder folder;
    const SimulatedPart part(SimulatedWay::kLoop);
    part.WriteStereoFolder(folder.Path());
    loop_ = new Loop;
    const Dataset dataset = OpenDataset({.folder = folder.Path()});
    loop_->rig = dataset.rig;
    FeatureOptions few;
    few.max_keypoints = 600;
    const FeatureSetup setup = MakeFeatureSetup(dataset.rig, few, {});
    for (const StereoFrame& frame : dataset.frames) {
      loop_->features.push_back(ExtractFeatures(frame, setup));
    }
    for (const DriveFrame& frame : part.frames()) loop_->truth.push_back(frame.world_from_left);
    loop_->odometry = TrackFrames(static_cast<int>(loop_->features.size()), Load, loop_->rig, {});
  }
  static void TearDownTestSuite() {
    delete loop_;
    loop_ = nullptr;
  }
  static FrameFeatures Load(int frame) { return loop_->features[frame]; }

  // Root mean square distance (m) of the adjusted positions from the true ones, after alignment.
  static double AdjustedError_m(const Odometry& odometry, const Correspondences& matches) {
    const auto start = RelaxPoses(StartingPoses(odometry, {}), odometry, matches.loop_closures);
    const Adjustment adjusted = AdjustBundle({matches, loop_->rig, start}, {});
    std::vector<Eigen::Vector3d> found, truth;
    for (std::size_t i = 0; i < loop_->truth.size(); ++i) {
      if (!adjusted.world_from_left[i]) continue;
      found.push_back(adjusted.world_from_left[i]->translation);
      truth.push_back(loop_->truth[i].translation);
    }
    EXPECT_EQ(found.size(), loop_->truth.size());
    const Sim3 truth_from_found = AlignPoints(found, truth, false);
    double square = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      square += (truth_from_found * found[i] - truth[i]).squaredNorm();
    }
    return std::sqrt(square / static_cast<double>(found.size()));
  }

  static double MotionError_m(const LoopClosure& loop_closure) {
    const Rigid3 b_from_a = loop_->truth[loop_closure.b].Inverse() * loop_->truth[loop_closure.a];
    return (loop_closure.b_from_a.translation - b_from_a.translation).norm();
  }

  struct Loop {
    StereoRig rig;
    std::vector<FrameFeatures> features;
    std::vector<Rigid3> truth;
    Odometry odometry;
  };
  static Loop* loop_;
};

LoopClosureTest::Loop* LoopClosureTest::loop_ = nullptr;

TEST_F(LoopClosureTest, IsFoundByItsAppearanceAndClosesTheLoop) {
  const Correspondences known = MatchFrames(loop_->odometry, Load, loop_->rig, {});
  const double without_drift_m = AdjustedError_m(loop_->odometry, known);
  ASSERT_FALSE(known.loop_closures.empty());

  // Three tenths of a degree and 3 % in each step: past the place by more than matches are looked
  // for.
  const Odometry drifting = Worsened(loop_->odometry, {0.03, 0.3 * std::numbers::pi / 180.0});
  MatchingOptions options;
  options.max_search_radius_px = 20.0;
  options.revisit_candidates = 0;
  EXPECT_TRUE(MatchFrames(drifting, Load, loop_->rig, options).loop_closures.empty());

  options.revisit_candidates = 3;
  const Correspondences found = MatchFrames(drifting, Load, loop_->rig, options);
  EXPECT_GE(found.loop_closures.size(), 5u);
  for (const LoopClosure& loop_closure : found.loop_closures) {
    EXPECT_TRUE(loop_closure.by_appearance);
    EXPECT_LT(MotionError_m(loop_closure), 0.02) << loop_closure.a << " " << loop_closure.b;
  }
  const double closed_m = AdjustedError_m(drifting, found);
  EXPECT_LT(closed_m, 1.2 * without_drift_m + 1e-4);
}

}  // namespace
}  // namespace rigmap
