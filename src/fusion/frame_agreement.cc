#include "fusion/internal/frame_agreement.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "fusion/internal/view_consistency.h"

namespace rigmap {
namespace {

struct RunningMean {
  double sum = 0.0;
  int count = 0;

  void Add(double value) {
    sum += value;
    ++count;
  }
  double Mean() const { return sum / count; }
};

double Steps(std::size_t from, std::size_t to) {
  return static_cast<double>(to) - static_cast<double>(from);
}

// Frames around one that shading is found from. Between others the ground was out of view, and how
// often it crossed the image since, nobody counts.
constexpr std::size_t kShadingReach = 15;

bool IsAround(std::size_t a, std::size_t b) { return std::abs(Steps(a, b)) <= kShadingReach; }

}  // namespace

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
  const double shading = LogShadingAround(frame);
  RunningMean corrected;
  for (const std::size_t i : ComparisonOf(frame).near) {
    const auto before = log_brightness_.find(i);
    const auto ratio = log_ratios_.find({frame, i});
    if (before == log_brightness_.end() || ratio == log_ratios_.end()) continue;
    const double shaded = IsAround(i, frame) ? shading * Steps(i, frame) : 0.0;
    corrected.Add(before->second + ratio->second - shaded);
  }
  const double log_brightness = corrected.count > 0 ? kKept * corrected.Mean() : 0.0;
  log_brightness_[frame] = log_brightness;
  return std::exp(log_brightness);
}

double FrameAgreement::LogShadingAround(std::size_t frame) {
  constexpr std::size_t kFewest = 16;  // frames; a step of the exposure shows in nine
  const std::size_t first = frame > kShadingReach ? frame - kShadingReach : 0;
  const std::size_t end = std::min(world_from_left_.size(), frame + kShadingReach + 1);
  std::vector<double> shadings;
  for (std::size_t i = first; i < end; ++i) {
    ShareOf(i);
    RunningMean before, after, steps;
    for (const std::size_t k : ComparisonOf(i).near) {
      const auto ratio = log_ratios_.find({i, k});
      if (ratio == log_ratios_.end() || !IsAround(i, k)) continue;
      (k < i ? before : after).Add(ratio->second);
      steps.Add(std::abs(Steps(k, i)));
    }
    if (before.count == 0 || after.count == 0) continue;
    shadings.push_back(0.5 * (before.Mean() - after.Mean()) / steps.Mean());
  }
  return shadings.size() < kFewest ? 0.0 : Median(std::move(shadings));
}

}  // namespace rigmap
