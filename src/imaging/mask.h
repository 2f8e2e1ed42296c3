// Which pixels may be used.
#pragma once

#include <opencv2/core.hpp>

#include "core/options.h"
#include "scene/rig.h"

namespace rigmap {

struct MaskOptions {
  // Grey value from which a pixel counts as saturated. Below 255, since JPEG and the conversion
  // from colour spread the value of a clipped pixel by a few levels.
  int saturation_level = 250;
  // Smallest width (px) of a saturated area; anything thinner is a glint or a bright pebble, which
  // has edges on both sides and is as good a feature as any.
  int saturation_width_px = 15;
  // Pixels beside a saturated area that go with it: blooming and the camera's sharpening shift
  // its edges, by about 2 px to either side.
  double saturation_margin_px = 3.0;
  // Leave out the sky: it has no finite depth, and its clouds move.
  bool sky = true;
  // Share of the image height that sky may reach down to; a rig that looks ahead or down has its
  // horizon above.
  double sky_lowest_share = 0.6;

  OptionFields Fields() {
    return {{"saturation_level", &saturation_level},
            {"saturation_width_px", &saturation_width_px},
            {"saturation_margin_px", &saturation_margin_px},
            {"sky", &sky},
            {"sky_lowest_share", &sky_lowest_share}};
  }
  void Validate() const;  // throws UsageError
};

// Masks are CV_8UC1 of the image's size: 255 usable, 0 not.

// What holds for every image of an eye: its calibrated region and its mask file. Throws DataError
// when the mask file cannot be read or is not of the camera's size.
cv::Mat StaticMask(const RigEye& eye);

// The static mask without saturated areas (not single glints) and, if asked for, the sky: a
// smooth or region that hangs from the top border and is clearly brighter than the
// image below. A dark sky and dark or textured walls stay. About 2 ms for 1024 x 768.
cv::Mat UsableMask(const cv::Mat& grey, const cv::Mat& static_mask, const MaskOptions& options);

}  // namespace rigmap
