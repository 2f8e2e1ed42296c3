#include "fusion/internal/frame_agreement.h"

#include <cmath>

#include "core/statistics.h"
#include "fusion/internal/view_consistency.h"

namespace rigmap {

const FrameComparison& FrameAgreement::ComparisonOf(std::size_t frame) {
  const auto known = comparisons_.find(frame);
  if (known != comparisons_.end()) return known->second;
  return comparisons_.emplace(frame, CompareWith(frame, world_from_left_, options_)).first->second;
}

bool FrameAgreement::IsSound(std::size_t frame) {
  const auto known = soundness_.find(frame);
  if (known != soundness_.end()) return known->second;
  return soundness_[frame] = AgreesAsOthersDo(frame);
}

bool FrameAgreement::AgreesAsOthersDo(std::size_t frame) {
  constexpr std::size_t kFewest = 3;
  constexpr double kShare = 0.5;
  const auto own = ShareOf(frame);
  std::vector<double> others;
  for (const std::size_t i : ComparisonOf(frame).near) {
    if (const auto share = ShareOf(i)) others.push_back(*share);
  }
  return !own || others.size() < kFewest || *own >= kShare * Median(std::move(others));
}

std::optional<double> FrameAgreement::ShareOf(std::size_t frame) {
  const auto known = shares_.find(frame);
  if (known != shares_.end()) return known->second;
  std::vector<std::size_t> frames{frame};
  for (const std::size_t i : ComparisonOf(frame).near) frames.push_back(i);
  const auto views = views_.Get(frames);
  std::vector<double> shares;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const auto agreement = AgreementOf(*views[0], *views[i], options_);
    if (!agreement) continue;
    shares.push_back(agreement->share);
    log_ratios_[{frame, frames[i]}] = std::log(agreement->brightness);
  }
  const auto share = shares.empty() ? std::nullopt : std::optional(Median(std::move(shares)));
  shares_.emplace(frame, share);
  return share;
}

double FrameAgreement::BrightnessFor(std::size_t frame) {
  constexpr double kKept = 0.97;  // of its logarithm, from frame to frame
  ShareOf(frame);                 // which finds the ratios
  double sum = 0.0;
  int count = 0;
  for (const std::size_t i : ComparisonOf(frame).near) {
    const auto before = log_brightness_.find(i);
    const auto ratio = log_ratios_.find({frame, i});
    if (before == log_brightness_.end() || ratio == log_ratios_.end()) continue;
    sum += before->second + ratio->second;
    ++count;
  }
  const double log_brightness = count > 0 ? kKept * sum / count : 0.0;
  log_brightness_[frame] = log_brightness;
  return std::exp(log_brightness);
}

}  // namespace rigmap
