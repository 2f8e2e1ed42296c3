// Which of two paths agrees better with fixes that neither was made of.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace rigmap {

// A fix beside both paths, each laid on the Earth by itself: from the fix to the antenna, east and
// north (m).
struct FixBesideTwoPaths {
  Eigen::Vector2d from_first = Eigen::Vector2d::Zero();
  Eigen::Vector2d from_second = Eigen::Vector2d::Zero();
  double sigma_m = 0.0;   // per axis, as stated
  std::int64_t turn = 0;  // of the same stretch of time: what their noise has in common counts once
};

struct FixJudgement {
  double first_m = 0.0, second_m = 0.0;  // root mean squares of the distances
  // By how much squared distances are smaller beside the second path, in sigmas of what the noise
  // of the fixes makes of it by chance: 0 for equal paths. Noise is as stated or as large as the
  // distances from the second path, where these are larger, and of fixes of the same turn as much
  // alike as these distances are.
  double gain_sigmas = 0.0;
};

// Fixes more than ten times the median off the first path judge nobody. Nothing where fewer than
// four are given.
std::optional<FixJudgement> JudgeByFixes(const std::vector<FixBesideTwoPaths>& fixes);

}  // namespace rigmap
