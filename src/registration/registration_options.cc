#include "registration/registration_options.h"

namespace rigmap {

OptionFields CloudOptions::Fields() {
  return {
      {"grid_m", &grid_m, "m", AtLeast(0.0),
       "Side of the box in which the points of a frame are merged to their mean. 0: a fortieth of "
       "the distance of near ground, rounded up to 1, 2 or 5 times a power of ten, 5 cm for a "
       "rover: relief of a few boxes is what holds a cloud in place. 1 to 10 cm are usual."},
      {"min_depth_m", &min_depth_m, "m", AtLeast(0.0),
       "What is nearer is masked. 0: nothing is that dense matching finds."},
      {"max_depth_m", &max_depth_m, "m", AtLeast(0.0),
       "What is further is masked. 0: where one standard deviation of a depth, at a tenth of a "
       "pixel of disparity, reaches grid_m."},
      {"max_above_m", &max_above_m, "m", AtLeast(0.0),
       "What is higher above the left camera, along its upward axis (-y), is masked. 0: nothing "
       "is."},
      {"max_below_m", &max_below_m, "m", AtLeast(0.0),
       "What is further below the left camera is masked, as max_above_m."},
      {"denoise_neighbours", &denoise_neighbours, "", AtLeast(0),
       "Statistical outlier removal: a point is dropped if the mean distance to so many neighbours "
       "is too large. 0: none is. As MATLAB's pcdenoise."},
      {"denoise_deviations", &denoise_deviations, "standard deviations", MoreThan(0.0),
       "By how much that distance may exceed the cloud's mean one. As MATLAB's pcdenoise."},
  };
}

void CloudOptions::RequireRelations() const {
  RequireOption(max_depth_m == 0.0 || max_depth_m > min_depth_m, "registration.max_depth_m",
                "0 or more than registration.min_depth_m", max_depth_m);
}

OptionFields RegistrationOptions::Fields() {
  return {
      {"way",
       ChoiceOf(&way),
       "",
       {},
       "plain: each cloud against that of the frame before by point-to-point ICP from the motion "
       "before, every pair of points counting, whatever the options below say. improved: as they "
       "say."},
      {"method",
       ChoiceOf(&method),
       "",
       {},
       "What ICP makes small: distances of points, their distances from the planes around the "
       "others (Chen and Medioni 1992), or plane to plane (generalised ICP, Segal 2009)."},
      {"first_guess",
       ChoiceOf(&first_guess),
       "",
       {},
       "Where ICP starts: where the reference is, from the motion before, from the visual "
       "odometry where that measured one (else from the motion before), or from wheels, gyro and "
       "inclinometer."},
      {"map_keyframes", &map_keyframes, "", AtLeast(1),
       "A cloud is registered against those of so many keyframes together."},
      {"keyframe_overlap", &keyframe_overlap, "", AtLeast(0.0).UpTo(1.0),
       "A frame becomes a keyframe when less than this share of its points has a counterpart. 1: "
       "every frame does."},
      {"max_correspondence_grids", &max_correspondence_grids, "grid_m", AtLeast(0.0),
       "Points further apart are not taken for the same surface. 0: no limit."},
      {"kept_share", &kept_share, "", MoreThan(0.0).UpTo(1.0),
       "Share of the pairs of points that count, the nearest ones."},
      {"max_normal_angle_deg", &max_normal_angle_deg, "deg", MoreThan(0.0).UpTo(180.0),
       "Pairs of points whose normals differ by more do not count."},
      {"max_iterations", &max_iterations, "", AtLeast(1), "Of ICP."},
      {"shared_noise", &shared_noise, "", AtLeast(1.0),
       "Sigmas of a step grow by this factor: noise that a whole frame shares, as that of "
       "matching, "
       "leaves no trace in residuals. With 2, squared errors of full-size parts were twice their "
       "variance, with 3 they are as large."},
      {"min_overlap", &min_overlap, "", AtLeast(0.0).UpTo(1.0),
       "With a smaller share of points that have a counterpart a registration has failed."},
  };
}

OptionFields MergeOptions::Fields() {
  return {{"merge_grid_m", &merge_grid_m, "m", AtLeast(0.0),
           "Side of the box in which the points of all clouds are merged to the map. 0: grid_m."}};
}

RegistrationOptions Resolved(const RegistrationOptions& options) {
  if (options.way == RegistrationWay::kImproved) return options;
  RegistrationOptions plain = options;
  plain.method = RegistrationMethod::kPointToPoint;
  plain.first_guess = FirstGuess::kPreviousMotion;
  plain.map_keyframes = 1;
  plain.keyframe_overlap = 1.0;
  plain.max_correspondence_grids = 0.0;
  plain.kept_share = 1.0;
  plain.max_normal_angle_deg = 180.0;
  return plain;
}

}  // namespace rigmap
