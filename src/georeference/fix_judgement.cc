#include "georeference/fix_judgement.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr std::size_t kFewest = 4;  // as many as are needed to tie
constexpr double kMaxOfMedian = 10.0;

// Sums over the fixes of each turn.
struct TurnSums {
  double count = 0.0, second_square = 0.0;
  Eigen::Vector2d second = Eigen::Vector2d::Zero(), noisy_shift = Eigen::Vector2d::Zero();
};

// How much alike the distances of a turn are: the mean product of any two over their mean square.
double CorrelationInTurns(const std::map<std::int64_t, TurnSums>& turns) {
  double products = 0.0, pairs = 0.0, squares = 0.0, count = 0.0;
  for (const auto& [turn, sums] : turns) {
    products += sums.second.squaredNorm() - sums.second_square;
    pairs += sums.count * (sums.count - 1.0);
    squares += sums.second_square;
    count += sums.count;
  }
  if (!(pairs > 0.0) || !(squares > 0.0)) return 0.0;
  return std::clamp(products / pairs / (squares / count), 0.0, 1.0);
}

}  // namespace

std::optional<FixJudgement> JudgeByFixes(const std::vector<FixBesideTwoPaths>& fixes) {
  if (fixes.size() < kFewest) return std::nullopt;
  std::vector<double> distances_m;
  for (const FixBesideTwoPaths& fix : fixes) distances_m.push_back(fix.from_first.norm());
  const double limit_m = kMaxOfMedian * Median(std::move(distances_m));
  std::vector<FixBesideTwoPaths> judges;
  std::ranges::copy_if(fixes, std::back_inserter(judges),
                       [&](const auto& fix) { return fix.from_first.norm() <= limit_m; });

  double first = 0.0, second = 0.0;
  for (const FixBesideTwoPaths& fix : judges) {
    first += fix.from_first.squaredNorm();
    second += fix.from_second.squaredNorm();
  }
  const auto count = static_cast<double>(judges.size());
  const double seen_variance = second / (2.0 * count);  // per axis
  // The gain is twice the noise times the shift, beside what no noise changes.
  double alone = 0.0, together = 0.0;  // its variance if no noise of a turn is alike, or all of it
  std::map<std::int64_t, TurnSums> turns;
  for (const FixBesideTwoPaths& fix : judges) {
    const double noise = std::sqrt(std::max(fix.sigma_m * fix.sigma_m, seen_variance));
    const Eigen::Vector2d noisy_shift = 2.0 * noise * (fix.from_second - fix.from_first);
    TurnSums& sums = turns[fix.turn];
    sums.count += 1.0;
    sums.second += fix.from_second;
    sums.second_square += fix.from_second.squaredNorm();
    sums.noisy_shift += noisy_shift;
    alone += noisy_shift.squaredNorm();
  }
  for (const auto& [turn, sums] : turns) together += sums.noisy_shift.squaredNorm();
  const double alike = CorrelationInTurns(turns);
  const double variance = (1.0 - alike) * alone + alike * together;
  return FixJudgement{std::sqrt(first / count), std::sqrt(second / count),
                      variance > 0.0 ? (first - second) / std::sqrt(variance) : 0.0};
}

}  // namespace rigmap
