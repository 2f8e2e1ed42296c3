// How depth maps become one surface.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in fusion_options.cc.

struct FusionOptions {
  static constexpr const char* kSection = "fusion";

  double steep_voxel_share = 0.5;
  int neighbours = 8;
  int ahead = 6;
  double max_neighbour_angle_deg = 60.0;
  double agreement_sigmas = 3.0;
  double max_incidence_deg = 83.0;
  int min_views = 2;
  double better_view_share = 0.85;
  int min_observations = 4;
  double max_sigma_m = 0.0;
  double max_sigma_pct = 2.0;

  OptionFields Fields();
  void RequireRelations() const;  // throws UsageError
};

}  // namespace rigmap
