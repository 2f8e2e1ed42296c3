#include "georeference/fix_judgement.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr std::size_t kFewest = 4;  // as many as are needed to tie
constexpr double kMaxOfMedian = 10.0;

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
  double variance = 0.0;
  for (const FixBesideTwoPaths& fix : judges) {
    const double noise = std::max(fix.sigma_m * fix.sigma_m, seen_variance);
    variance += 4.0 * noise * (fix.from_second - fix.from_first).squaredNorm();
  }
  return FixJudgement{std::sqrt(first / count), std::sqrt(second / count),
                      variance > 0.0 ? (first - second) / std::sqrt(variance) : 0.0};
}

}  // namespace rigmap
