#include "fusion/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/progress.h"
#include "core/statistics.h"
#include "fusion/frame_comparison.h"
#include "fusion/tiled_grid.h"
#include "fusion/view_cache.h"
#include "fusion/view_consistency.h"

namespace rigmap {
namespace {

class DepthFusion {
 public:
  DepthFusion(std::span<const PosedDepth> depths, const FusionOptions& options)
      : options_(options), views_(depths, kCachedViews) {
    for (const PosedDepth& depth : depths) world_from_left_.push_back(depth.world_from_left);
  }

  bool IsSound(std::size_t frame) {
    const auto known = soundness_.find(frame);
    if (known != soundness_.end()) return known->second;
    return soundness_[frame] = AgreesAsOthersDo(frame);
  }

  // The reference and those with which it is compared have to be sound.
  std::vector<SurfaceSample> Samples(std::size_t reference) {
    FrameComparison compared = CompareWith(reference, world_from_left_, options_);
    const auto is_unsound = [this](std::size_t frame) { return !IsSound(frame); };
    std::erase_if(compared.near, is_unsound);
    std::erase_if(compared.ahead, is_unsound);
    std::vector<std::size_t> frames{reference};
    frames.insert(frames.end(), compared.near.begin(), compared.near.end());
    frames.insert(frames.end(), compared.ahead.begin(), compared.ahead.end());
    const auto views = views_.Get(frames);
    const auto first_ahead = views.begin() + 1 + static_cast<std::ptrdiff_t>(compared.near.size());
    auto samples = ConfirmedSamples(
        *views[0], {{views.begin() + 1, first_ahead}, {first_ahead, views.end()}}, options_);
    Brighten(BrightnessFor(reference), samples);
    return samples;
  }

 private:
  std::vector<std::size_t> Near(std::size_t frame) const {
    return CompareWith(frame, world_from_left_, options_).near;
  }

  bool AgreesAsOthersDo(std::size_t frame) {
    constexpr std::size_t kFewest = 3;  // neighbours, to tell which of two is wrong
    constexpr double kShare = 0.5;
    const auto own = ShareOf(frame);
    std::vector<double> others;
    for (const std::size_t i : Near(frame)) {
      if (const auto agreement = ShareOf(i)) others.push_back(*agreement);
    }
    return !own || others.size() < kFewest || *own >= kShare * Median(std::move(others));
  }

  // The factor that makes a frame as bright as those before it, since an exposure may step. It goes
  // back to 1 over some thirty frames, lest errors add up.
  double BrightnessFor(std::size_t frame) {
    constexpr double kKept = 0.97;  // of its logarithm, from frame to frame
    double sum = 0.0;
    int count = 0;
    for (const std::size_t i : Near(frame)) {
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

  static void Brighten(double factor, std::vector<SurfaceSample>& samples) {
    for (SurfaceSample& sample : samples) {
      for (std::uint8_t& value : sample.rgb) {
        value = static_cast<std::uint8_t>(std::clamp(std::lround(factor * value), 0L, 255L));
      }
    }
  }

  // With its neighbours, of which half agree with it better; nothing where it shares no view.
  std::optional<double> ShareOf(std::size_t frame) {
    const auto known = shares_.find(frame);
    if (known != shares_.end()) return known->second;
    std::vector<std::size_t> frames{frame};
    for (const std::size_t i : Near(frame)) frames.push_back(i);
    const auto views = views_.Get(frames);
    std::vector<double> shares;
    for (std::size_t i = 1; i < views.size(); ++i) {
      const auto agreement = AgreementOf(*views[0], *views[i], options_);
      if (!agreement) continue;
      shares.push_back(agreement->share);
      log_ratios_[{frame, frames[i]}] = std::log(agreement->brightness);
    }
    const auto agreement = shares.empty() ? std::nullopt : std::optional(Median(std::move(shares)));
    shares_.emplace(frame, agreement);
    return agreement;
  }

  const FusionOptions& options_;
  std::vector<Rigid3> world_from_left_;
  ViewCache views_;
  std::map<std::size_t, std::optional<double>> shares_;
  std::map<std::size_t, bool> soundness_;
  std::map<std::pair<std::size_t, std::size_t>, double> log_ratios_;  // the second's to the first's
  std::map<std::size_t, double> log_brightness_;                      // of frames that gave samples
};

}  // namespace

std::vector<std::size_t> FuseDepthMaps(std::span<const PosedDepth> depths,
                                       const FusionOptions& options, const FusionTarget& target) {
  options.Validate();
  DepthFusion fusion(depths, options);
  TiledGrid grid(options.voxel_m, target.scratch);
  std::vector<std::size_t> left_out;
  Progress progress("fusion", depths.size());
  for (std::size_t frame = 0; frame < depths.size(); ++frame) {
    if (fusion.IsSound(frame)) {
      for (const SurfaceSample& sample : fusion.Samples(frame)) grid.Add(sample);
      grid.SetAside();
    } else {
      left_out.push_back(frame);
    }
    progress.Advance();
  }
  grid.Drain(options.min_observations, options.max_sigma_m, target.take);
  return left_out;
}

}  // namespace rigmap
