#include "fusion/fusion_options.h"

namespace rigmap {

void VoxelOptions::Validate() const {
  RequireOption(voxel_m >= 1e-4, "fusion.voxel_m", "at least 0.0001", voxel_m);
}

void FusionOptions::Validate() const {
  RequireOption(steep_voxel_share >= 0.1 && steep_voxel_share <= 1.0, "fusion.steep_voxel_share",
                "0.1 to 1", steep_voxel_share);
  RequireOption(neighbours >= 0, "fusion.neighbours", "at least 0", neighbours);
  RequireOption(ahead >= 0, "fusion.ahead", "at least 0", ahead);
  RequireOption(max_neighbour_angle_deg > 0.0 && max_neighbour_angle_deg <= 180.0,
                "fusion.max_neighbour_angle_deg", "above 0, at most 180", max_neighbour_angle_deg);
  RequireOption(agreement_sigmas > 0.0, "fusion.agreement_sigmas", "above 0", agreement_sigmas);
  RequireOption(max_incidence_deg > 0.0 && max_incidence_deg <= 90.0, "fusion.max_incidence_deg",
                "above 0, at most 90", max_incidence_deg);
  RequireOption(min_views >= 1 && min_views <= neighbours + 1, "fusion.min_views",
                "1 to fusion.neighbours + 1", min_views);
  RequireOption(better_view_share >= 0.0 && better_view_share <= 1.0, "fusion.better_view_share",
                "0 to 1", better_view_share);
  RequireOption(min_observations >= 1, "fusion.min_observations", "at least 1", min_observations);
  RequireOption(max_sigma_m > 0.0, "fusion.max_sigma_m", "above 0", max_sigma_m);
}

}  // namespace rigmap
