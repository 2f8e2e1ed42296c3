#include "workflows/stages/dense_memory.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/memory_share.h"
#include "dense/dense_matcher.h"
#include "dense/seen_depths.h"

namespace rigmap {

int FramesAtOnce(double frame_mb, double nearest_m, const DenseRoom& room) {
  if (kProgramMegabytes + frame_mb > room.allowed_mb) {
    throw UsageError(fmt::format(
        "--memory: expected at least {:.0f} MB, for images as large as these, found {}{}",
        std::ceil(kProgramMegabytes + frame_mb), room.allowed_mb,
        std::isfinite(nearest_m)
            ? fmt::format("; dense.min_depth_m, if more than {:.2g} m, needs less", nearest_m)
            : ""));
  }
  const int at_once = std::min(static_cast<int>(room.room_mb / frame_mb), room.threads);
  if (at_once > 0) return at_once;
  spdlog::warn(
      "depth maps are made one at a time and may take more than --memory: of {} MB {:.0f} are "
      "left, "
      "and one takes {:.0f}",
      room.allowed_mb, std::max(0.0, room.room_mb), frame_mb);
  return 0;
}

double RequireMemoryForDepth(const StereoRig& rig, const DenseOptions& options,
                             const MaskOptions& masks, int allowed_mb) {
  // What the images show is not known yet: as near as a stereo camera sees.
  const double nearest_m =
      options.min_depth_m > 0.0 ? options.min_depth_m : DepthsSeen(rig, {}, {}).nearest_m;
  const DenseMatcher matcher(rig, nearest_m, options, masks);
  // A nearest depth that is no help is not spoken of.
  constexpr double kMuchFurther = 16.0;
  const DenseMatcher far_matcher(rig, kMuchFurther * nearest_m, options, masks);
  const bool helps = kProgramMegabytes + far_matcher.MegabytesPerFrame() <= allowed_mb;
  FramesAtOnce(matcher.MegabytesPerFrame(),
               helps ? nearest_m : std::numeric_limits<double>::infinity(),
               {static_cast<double>(allowed_mb), allowed_mb, 1});
  return matcher.MegabytesPerView();
}

}  // namespace rigmap
