#include "scene/voxel_options.h"

namespace rigmap {

OptionFields VoxelOptions::Fields() {
  return {
      {"voxel_m", &voxel_m, "m", AtLeast(1e-4).UpTo(1000.0),
       "Side of the cubes that points are merged in, and of the cells of height map and "
       "ortho-image. About a pixel at 8 m for 840 px, finer than the noise of depth from 2 m on."},
  };
}

}  // namespace rigmap
