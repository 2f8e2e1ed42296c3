// How the depth maps of a part go together, frame with frame.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fusion/internal/frame_comparison.h"
#include "fusion/internal/view_cache.h"

namespace rigmap {

// Works out what it is asked for and remembers it. Frames by their index. Not thread-safe.
class FrameAgreement {
 public:
  // All must outlive this. The poses are those of the views.
  FrameAgreement(std::span<const Rigid3> world_from_left, const FusionOptions& options,
                 ViewCache& views)
      : world_from_left_(world_from_left), options_(options), views_(views) {}

  // With whom a frame is compared, sound or not.
  const FrameComparison& ComparisonOf(std::size_t frame);

  // False if the frame agrees with its neighbours on less than half of the pixels on which they
  // agree with theirs. With fewer than three neighbours nobody can tell which of two is wrong.
  bool IsSound(std::size_t frame);

  // The factor that makes a frame as bright as its neighbours among those asked about before, since
  // an exposure may step. It goes back to 1 over some thirty frames, lest errors add up.
  double BrightnessFor(std::size_t frame);

 private:
  bool AgreesAsOthersDo(std::size_t frame);
  // Lenses shade the edges of images, and who drives on sees the same ground ever nearer to the
  // edge. What views before and after a frame differ by in opposite ways, in the median of the
  // frames around, is that and not the exposure: by so much each view seems brighter than the
  // one after it.
  double LogShadingAround(std::size_t frame);
  // With its neighbours, of which half agree with it better; nothing where it shares no view.
  std::optional<double> ShareOf(std::size_t frame);

  std::span<const Rigid3> world_from_left_;
  const FusionOptions& options_;
  ViewCache& views_;
  std::map<std::size_t, FrameComparison> comparisons_;
  std::map<std::size_t, std::optional<double>> shares_;
  std::map<std::size_t, bool> soundness_;
  std::map<std::pair<std::size_t, std::size_t>, double> log_ratios_;  // the second's to the first's
  std::map<std::size_t, double> log_brightness_;
};

}  // namespace rigmap
