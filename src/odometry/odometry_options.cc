#include "odometry/odometry_options.h"

namespace rigmap {

OptionFields OdometryOptions::Fields() {
  return {{"keypoint_noise_px", &keypoint_noise_px},
          {"disparity_noise_px", &disparity_noise_px},
          {"shared_noise", &shared_noise},
          {"max_sigmas", &max_sigmas},
          {"min_inliers", &min_inliers},
          {"keyframe_min_seen_share", &keyframe_min_seen_share},
          {"keyframe_max_shift_share", &keyframe_max_shift_share},
          {"stand_still_sigmas", &stand_still_sigmas},
          {"search_radius_px", &search_radius_px},
          {"speed_change_share", &speed_change_share},
          {"turn_change_rad_per_s", &turn_change_rad_per_s}};
}

void OdometryOptions::Validate() const {
  const auto positive = [](const char* name, double value) {
    RequireOption(value > 0.0, std::string("odometry.") + name, "more than 0", value);
  };
  positive("keypoint_noise_px", keypoint_noise_px);
  positive("disparity_noise_px", disparity_noise_px);
  RequireOption(shared_noise >= 1.0, "odometry.shared_noise", "1 or more", shared_noise);
  positive("max_sigmas", max_sigmas);
  positive("stand_still_sigmas", stand_still_sigmas);
  positive("search_radius_px", search_radius_px);
  positive("speed_change_share", speed_change_share);
  positive("turn_change_rad_per_s", turn_change_rad_per_s);
  RequireOption(min_inliers >= 6, "odometry.min_inliers", "at least 6", min_inliers);
  RequireOption(keyframe_min_seen_share >= 0.0 && keyframe_min_seen_share <= 1.0,
                "odometry.keyframe_min_seen_share", "0 to 1", keyframe_min_seen_share);
  RequireOption(keyframe_max_shift_share > 0.0 && keyframe_max_shift_share <= 1.0,
                "odometry.keyframe_max_shift_share", "0 to 1", keyframe_max_shift_share);
}

}  // namespace rigmap
