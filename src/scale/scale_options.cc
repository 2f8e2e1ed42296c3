#include "scale/scale_options.h"

namespace rigmap {

OptionFields ScaleOptions::Fields() {
  return {
      {"max_sigmas", &max_sigmas, "robust sigmas", MoreThan(0.0),
       "A pair is rejected if its left-right distance is off the median by more than this and by "
       "more than min_tolerated_share. Normal noise reaches five sigmas in none of a part's "
       "pairs."},
      {"min_tolerated_share", &min_tolerated_share, "", AtLeast(0.0),
       "Share of the median distance that is always tolerated: COLMAP's own noise on a healthy "
       "model is 0.1 to 0.9 %."},
  };
}

}  // namespace rigmap
