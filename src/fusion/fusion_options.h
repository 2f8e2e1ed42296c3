// How depth maps become one surface.
#pragma once

#include "core/options.h"

namespace rigmap {

struct FusionOptions {
  // Side of the cubes (m) in which points are merged: about a pixel at 8 m for 840 px, and finer
  // than the depth noise from 2 m on.
  double voxel_m = 0.01;
  // Frames, nearest in place, that each depth map is compared with. Eight span four frames to
  // either side: enough to average over, still the same rocks in view.
  int neighbours = 8;
  // Largest angle (degrees) between the viewing directions of two frames that are compared.
  double max_neighbour_angle_deg = 60.0;
  // Depths agree if their difference is below this many of its standard deviations.
  double agreement_sigmas = 3.0;
  // Frames (itself included) that must agree on a point. One alone may be a false match.
  int min_views = 2;
  // A frame leaves a point to a neighbour that agrees and sees it with less than this share of its
  // own sigma. 0.85: a twelfth closer.
  double better_view_share = 0.85;
  // Depth pixels (agreeing ones of neighbours included) below which a voxel is a stray.
  int min_observations = 4;

  OptionFields Fields() {
    return {{"voxel_m", &voxel_m},
            {"neighbours", &neighbours},
            {"max_neighbour_angle_deg", &max_neighbour_angle_deg},
            {"agreement_sigmas", &agreement_sigmas},
            {"min_views", &min_views},
            {"better_view_share", &better_view_share},
            {"min_observations", &min_observations}};
  }
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
