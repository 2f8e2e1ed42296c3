// How depth maps become one surface.
#pragma once

#include "core/options.h"

namespace rigmap {

// The grid of the map: read by every stage that asks how fine the map is.
struct VoxelOptions {
  // Side of the cubes (m) in which points are merged: about a pixel at 8 m for 840 px, and finer
  // than the depth noise from 2 m on.
  double voxel_m = 0.01;

  OptionFields Fields() { return {{"voxel_m", &voxel_m}}; }
  void Validate() const;  // throws UsageError
};

struct FusionOptions {
  // Side of the cubes on faces steeper than 45 degrees, as a share of voxel_m. Rocks are small, and
  // their faces are seen head on: at three metres a pixel of 840 px focal length covers 4 mm of
  // them.
  double steep_voxel_share = 0.5;
  // Frames, nearest in place, that each depth map is compared with. Eight span four frames to
  // either side: enough to average over, still the same rocks in view.
  int neighbours = 8;
  // Further frames ahead, ever more apart, that are asked whether they see a point better or see
  // through it. Six reach about twenty frames ahead.
  int ahead = 6;
  // Largest angle (degrees) between the viewing directions of two frames that are compared.
  double max_neighbour_angle_deg = 60.0;
  // Depths agree if their difference is below this many of its standard deviations.
  double agreement_sigmas = 3.0;
  // Largest angle (degrees) between a surface's normal and the ray that sees it. What is seen more
  // edge on is mostly no surface: where depth jumps, matched disparities lead from one side to the
  // other over some eight pixels. 83: level ground eight times as far away as the camera is high.
  double max_incidence_deg = 83.0;
  // Frames (itself included) that must agree on a point. One alone may be a false match.
  int min_views = 2;
  // A frame leaves a point to one that looks at it from nearer, where a disparity makes less than
  // this share of the depth's sigma. 0.85: a twelfth closer.
  double better_view_share = 0.85;
  // Depth pixels (agreeing ones of neighbours included) below which a voxel is a stray; of smaller
  // voxels, steep_voxel_share of it.
  int min_observations = 4;
  // Largest standard deviation (m) of a point, three voxels: of less certain ones every third
  // beside a rock hangs in the air. Reached at about six metres with a baseline of 0.12 m and 840
  // px.
  double max_sigma_m = 0.03;

  OptionFields Fields() {
    return {{"steep_voxel_share", &steep_voxel_share},
            {"neighbours", &neighbours},
            {"ahead", &ahead},
            {"max_neighbour_angle_deg", &max_neighbour_angle_deg},
            {"agreement_sigmas", &agreement_sigmas},
            {"max_incidence_deg", &max_incidence_deg},
            {"min_views", &min_views},
            {"better_view_share", &better_view_share},
            {"min_observations", &min_observations},
            {"max_sigma_m", &max_sigma_m}};
  }
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
