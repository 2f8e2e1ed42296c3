#include "gates/length_gate.h"

#include <cmath>

namespace rigmap {

Gate JudgeLength(const std::vector<std::optional<Rigid3>>& world_from_left,
                 const Odometry& odometry, double baseline_m, double accuracy_pct) {
  double judged_m = 0.0, seen_m = 0.0;
  std::optional<std::size_t> last;  // that both know, nothing guessed by the odometry since
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (odometry[i].source != PoseSource::kOdometry) last.reset();
    if (odometry[i].source != PoseSource::kOdometry || !world_from_left[i]) continue;
    if (last) {
      judged_m += (world_from_left[i]->translation - world_from_left[*last]->translation).norm();
      seen_m +=
          (odometry[i].world_from_left.translation - odometry[*last].world_from_left.translation)
              .norm();
    }
    last = i;
  }
  const auto apart_pct =
      seen_m > baseline_m ? std::optional(100.0 * std::abs(judged_m / seen_m - 1.0)) : std::nullopt;
  return AtMost("length_pct", apart_pct, accuracy_pct,
                "length of the way against that of the visual odometry, per cent");
}

}  // namespace rigmap
