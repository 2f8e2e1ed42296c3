#include "imaging/mask_options.h"

namespace rigmap {

OptionFields MaskOptions::Fields() {
  return {
      {"black_level", &black_level, "grey value", AtLeast(0).UpTo(255),
       "Below this value a pixel counts as clipped, too (0: none does), where a square of "
       "saturation_width_px (for depth, one of dense.block_px) is that dark: nothing is to be seen "
       "there."},
      {"saturation_level", &saturation_level, "grey value", AtLeast(1).UpTo(256),
       "From this value on a pixel counts as clipped (256: none does). Below 255, since JPEG and "
       "the conversion from colour spread a clipped value by a few levels."},
      {"saturation_width_px", &saturation_width_px, "px", AtLeast(1),
       "A clipped area narrower than this is a glint or a bright pebble: as good a feature as "
       "any."},
      {"saturation_margin_px", &saturation_margin_px, "px", AtLeast(0.0),
       "Margin around a clipped area that is left out with it: blooming and sharpening move its "
       "edges by about 2 px."},
      {"sky",
       &sky,
       "",
       {},
       "Leave out the sky. It has no depth that stereo could find, and clouds move."},
      {"sky_lowest_share", &sky_lowest_share, "of the image height", MoreThan(0.0).Below(1.0),
       "How far down sky may reach. A rig that looks ahead or down has its horizon above that."},
  };
}

}  // namespace rigmap
