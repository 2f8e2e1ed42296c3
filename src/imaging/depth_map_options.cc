#include "imaging/depth_map_options.h"

namespace rigmap {

OptionFields DepthMapOptions::Fields() {
  return {
      {"depth_maps",
       &depth_maps,
       "",
       {},
       "Write the depth of each frame of the map and its sigma as images, too, and a workspace "
       "for COLMAP's fusion and meshing (--depth-maps)."},
  };
}

}  // namespace rigmap
