// Whether stereo depth and temporal depth agree all over the image.
//
// Both come from one adjustment. Poses and their scale follow the same stereo matches, so that a
// factor or an offset which all of the image shares is taken up by them and cannot be seen here,
// and what a wrong lens does alike to both does not show either. What is seen is how they differ
// over the image: there the metres of one region contradict those of another.
#pragma once

#include <optional>
#include <vector>

#include "gates/temporal_depth.h"

namespace rigmap {

// A robust mean with its standard error, both of one unit. Tracks are independent, their
// observations are not.
struct MeanDifference {
  double mean = 0.0, sigma = 0.0;
};

// Stereo less temporal, in one region of the image.
struct RegionDifference {
  int tracks = 0;
  MeanDifference disparity_px;
  MeanDifference depth_pct;  // of the depth: the region's own scale
};

// Root mean square of the regions' means, weighted by their tracks, less what their standard errors
// explain; with the uncertainty of that.
struct SystematicDifference {
  double value = 0.0, sigma = 0.0;
};

// Regions with fewer than 20 tracks have nothing.
struct DepthPartition {
  std::vector<std::optional<RegionDifference>> regions;
  SystematicDifference disparity_px, depth_pct;
};

struct DepthConsistency {
  static constexpr int kRings = 5, kColumns = 4, kRows = 3;

  // Equally wide rings about the principal point, out to the farthest corner.
  DepthPartition radius;
  // Row by row from the upper left.
  DepthPartition cells;
  double ring_width_px = 0.0;
};

// Nothing where no region has enough: a rig that stands, or one or two features.
std::optional<DepthConsistency> DepthConsistencyOf(const Adjustment& adjustment);

}  // namespace rigmap
