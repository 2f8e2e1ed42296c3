#include "fusion/fusion_options.h"

namespace rigmap {

OptionFields FusionOptions::Fields() {
  const OptionFields compared = {
      {"steep_voxel_share", &steep_voxel_share, "of voxel_m", AtLeast(0.1).UpTo(1.0),
       "Side of the cubes on faces steeper than 45 degrees. Rocks are small, and their faces are "
       "seen head on: at three metres a pixel of 840 px focal length covers 4 mm of them."},
      {"neighbours", &neighbours, "", AtLeast(0),
       "Frames that a depth map is compared with, the nearest ones. Eight reach four frames to "
       "either side, which still see the same rocks. Further ones take the places of up to half of "
       "them where they show what none of the nearest does."},
      {"ahead", &ahead, "", AtLeast(0),
       "Further frames ahead, ever more apart (six reach some twenty frames), that are asked "
       "whether they see a point from clearly nearer: if so they give it themselves, or deny it."},
      {"max_neighbour_angle_deg", &max_neighbour_angle_deg, "degrees", MoreThan(0.0).UpTo(180.0),
       "Frames whose viewing directions differ by more are not compared."},
      {"agreement_sigmas", &agreement_sigmas, "sigmas", MoreThan(0.0),
       "Depths agree within so many sigmas of their difference."},
  };
  const OptionFields kept = {
      {"max_incidence_deg", &max_incidence_deg, "degrees", MoreThan(0.0).UpTo(90.0),
       "A pixel whose ray leaves the surface's normal by more is left out, unless the surface goes "
       "on "
       "around it. Where depth jumps, matched disparities lead from one side to the other over "
       "some "
       "eight pixels, and that slope is seen all but edge on, as is far ground."},
      {"min_views", &min_views, "", AtLeast(1),
       "Frames, the own one included, that must agree on a point; at most neighbours + 1. A single "
       "one may be a false match."},
      {"better_view_share", &better_view_share, "", AtLeast(0.0).UpTo(1.0),
       "A frame leaves a point to one that looks at it from nearer, where a disparity makes less "
       "than this share of the depth's sigma; at 0.85 from a twelfth closer."},
      {"min_observations", &min_observations, "", AtLeast(1),
       "A voxel with fewer depth pixels, those of agreeing frames included, is a stray; on steep "
       "faces steep_voxel_share of it is enough."},
      {"max_sigma_m", &max_sigma_m, "m", AtLeast(0.0),
       "A point with a larger sigma is left out. 0: however large it is, each point has its own in "
       "dense.ply."},
      {"max_sigma_pct", &max_sigma_pct, "per cent of the distance", MoreThan(0.0),
       "What is known less well than this share of its distance from the camera is left out: at 2, "
       "disparities below 8 px that only one frame knows to 0.15 px. A single pair has its whole "
       "depth "
       "map, of which dense.max_depth_sigma_pct decides."},
  };
  return JoinFields({compared, kept});
}

void FusionOptions::RequireRelations() const {
  RequireOption(min_views <= neighbours + 1, "fusion.min_views", "at most fusion.neighbours + 1",
                min_views);
}

}  // namespace rigmap
