#include "odometry/followed_corners.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "odometry/internal/find_motion.h"
#include "trajectory/lost_frames.h"
#include "trajectory/motion_model.h"

namespace rigmap {
namespace {

class CornerBridger {
 public:
  CornerBridger(const Odometry& odometry, const CornerSource& follow, const StereoRig& rig,
                const OdometryOptions& options)
      : before_(odometry), odometry_(odometry), follow_(follow), rig_(rig), options_(options) {}

  Odometry Bridge(const std::vector<int>& lost) {
    int bridged = 0;
    for (int i = 1; i < static_cast<int>(odometry_.size()); ++i) {
      if (odometry_[i].reference >= i) continue;
      FollowReference(before_, i, odometry_);
      if (std::ranges::binary_search(lost, i) && Pose(i)) ++bridged;
    }
    if (bridged > 0) {
      spdlog::info("{} frames are posed by corners that were followed", bridged);
      BridgePredicted(odometry_);
    }
    return std::move(odometry_);
  }

 private:
  bool Pose(int i) {
    if (PoseAgainst(i - 1, i)) return true;
    // Between two frames there may be some that show nothing.
    int last = i - 1;
    while (last > 0 && odometry_[last].source == PoseSource::kPredicted) --last;
    return last < i - 1 && PoseAgainst(last, i);
  }

  bool PoseAgainst(int reference, int i) {
    FollowedCorners corners = follow_(reference, i);
    const Reference from = MakeReference(reference, std::move(corners.from), rig_, options_);
    const Rigid3 predicted =
        odometry_[i].world_from_left.Inverse() * odometry_[reference].world_from_left;
    const auto found = FindMotion(from, corners.to, rig_, predicted, options_, MatchBy::kTracks);
    if (!found || 2 * found->inliers <= found->matches) return false;
    SetPose(*found, reference, odometry_[reference].world_from_left, options_, odometry_[i]);
    return true;
  }

  const Odometry& before_;
  Odometry odometry_;
  const CornerSource& follow_;
  const StereoRig& rig_;
  const OdometryOptions& options_;
};

}  // namespace

Odometry BridgeByCorners(Odometry odometry, const CornerSource& follow, const StereoRig& rig,
                         const OdometryOptions& options) {
  const std::vector<int> lost = LostFrames(odometry);
  if (lost.empty()) return odometry;
  return CornerBridger(odometry, follow, rig, options).Bridge(lost);
}

}  // namespace rigmap
