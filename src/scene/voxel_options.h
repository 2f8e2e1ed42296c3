// How fine the map is.
#pragma once

#include "core/options.h"

namespace rigmap {

// The grid of the map: read by every stage that asks how fine the map is.
struct VoxelOptions {
  static constexpr const char* kSection = "fusion";

  double voxel_m = 0.0;  // 0: VoxelFor

  OptionFields Fields();
};

}  // namespace rigmap
