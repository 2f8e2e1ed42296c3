#include "adjustment/carry_groups.h"

namespace rigmap {

void CarryGroupsAlong(const std::vector<std::optional<Rigid3>>& start, Adjustment& adjustment) {
  auto& poses = adjustment.world_from_left;
  const std::vector<int>& datum_frames = adjustment.datum_frames;
  const int count = static_cast<int>(poses.size());
  std::vector<Rigid3> moves(poses.size());  // of the group, by its datum frame
  int before = -1;                          // the last frame posed
  for (int i = 0; i < count; ++i) {
    if (!poses[i]) continue;
    if (datum_frames[i] == i && before >= 0 && start[before] && start[i]) {
      const Rigid3 kept =
          moves[datum_frames[before]] * *poses[before] * start[before]->Inverse() * *start[i];
      moves[i] = kept * poses[i]->Inverse();
    }
    before = i;
  }
  for (AdjustedPoint& point : adjustment.points) {
    point.x = moves[datum_frames[point.observations.front().frame]] * point.x;
  }
  for (int i = 0; i < count; ++i) {
    if (!poses[i]) continue;
    const Rigid3& move = moves[datum_frames[i]];
    poses[i] = move * *poses[i];
    if (adjustment.covariances.empty()) continue;
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = move.rotation.toRotationMatrix();
    adjustment.covariances[i] = turn * adjustment.covariances[i] * turn.transpose();
    if (i < static_cast<int>(adjustment.link_covariances.size()) &&
        adjustment.link_covariances[i]) {
      adjustment.link_covariances[i] = turn * *adjustment.link_covariances[i] * turn.transpose();
    }
    if (adjustment.by_calibration.empty()) continue;
    adjustment.by_calibration[i] = turn * adjustment.by_calibration[i];
  }
}

}  // namespace rigmap
