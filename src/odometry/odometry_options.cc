#include "odometry/odometry_options.h"

namespace rigmap {

OptionFields OdometryOptions::Fields() {
  return {
      {"keypoint_noise_px", &keypoint_noise_px, "px", MoreThan(0.0),
       "Sigma of a matched keypoint, for weights and sigmas. Measured on sand: SIFT matches "
       "scatter by 0.3 px."},
      {"disparity_noise_px", &disparity_noise_px, "px", MoreThan(0.0),
       "Sigma of the disparity of a stereo match. Measured on sand: aligned stereo matches "
       "scatter by 0.1 px."},
      {"shared_noise", &shared_noise, "", AtLeast(1.0),
       "Sigmas of a motion grow by this factor: noise that all matches of a frame share leaves no "
       "trace in their residuals. As in the adjustment, where it was measured."},
      {"max_sigmas", &max_sigmas, "sigmas", MoreThan(0.0),
       "A match agrees with a motion within so many sigmas."},
      {"min_inliers", &min_inliers, "", AtLeast(6),
       "Fewer agreeing matches make no motion: wrong motions collect ten by chance."},
      {"keyframe_min_seen_share", &keyframe_min_seen_share, "", AtLeast(0.0).UpTo(1.0),
       "A new keyframe is made when less than this share of the last one's stereo points is still "
       "seen."},
      {"keyframe_max_shift_share", &keyframe_max_shift_share, "", MoreThan(0.0).UpTo(1.0),
       "A new keyframe is made when the median stereo point has moved by more than this share of "
       "the image width."},
      {"stand_still_sigmas", &stand_still_sigmas, "sigmas", MoreThan(0.0),
       "A motion below so many of its own sigmas, root mean square over its six coordinates, is "
       "taken for none: the rig stands."},
      {"search_radius_px", &search_radius_px, "px", MoreThan(0.0),
       "Half width of the first search, around the predicted position. Without success the whole "
       "image is searched."},
      {"speed_change_share", &speed_change_share, "", MoreThan(0.0),
       "Sigma of the speed while nothing can be measured, as a share of the largest speed of the "
       "part. It may last as long as the gap. What the wheels of a rover can do."},
      {"turn_change_rad_per_s", &turn_change_rad_per_s, "rad/s", MoreThan(0.0),
       "Sigma of the turn rate while nothing can be measured. What the wheels of a rover can do."},
  };
}

}  // namespace rigmap
