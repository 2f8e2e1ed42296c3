#include "scene/voxel_options.h"

namespace rigmap {

OptionFields VoxelOptions::Fields() {
  return {
      {"voxel_m", &voxel_m, "m", AtLeast(0.0).UpTo(1000.0),
       "Side of the smallest cubes that points are merged in, and of the cells of height map and "
       "ortho-image. 0: a pixel on near ground or the sigma of its depth, rounded up to 1 or 3 "
       "times "
       "a power of ten; 1 cm for a baseline of 0.12 m, 840 px and ground from 1.4 to 2.6 m on. "
       "Points that are not known to three such cubes go into larger ones."},
  };
}

}  // namespace rigmap
