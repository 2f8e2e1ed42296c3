// Options of the stage `scale`.
#pragma once

#include "core/options.h"

namespace rigmap {

struct ScaleOptions {
  // A pair is rejected when its distance lies further from the median than so many robust sigmas,
  // and further than the share: COLMAP's own noise on a healthy model is 0.1 to 0.9 %.
  double max_sigmas = 5.0;
  double min_tolerated_share = 0.01;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
