#include "dead_reckoning/dead_reckoning_options.h"

namespace rigmap {

OptionFields DeadReckoningOptions::Fields() {
  return {
      {"wheel_radius_m", &wheel_radius_m, "m", MoreThan(0.0),
       "Radius of the wheels where the rig file states none. That of Katwijk's rover is not "
       "published; this one was fitted to its drives."},
      {"wheel_slip", &wheel_slip, "", AtLeast(-0.5).UpTo(0.9),
       "Share by which the wheels turn farther than the ground passes. A driven wheel on level "
       "sand "
       "turns 0 to 5 % farther; less than nothing it cannot. This is the middle."},
      {"wheel_scale_sigma", &wheel_scale_sigma, "", MoreThan(0.0),
       "Sigma of the metres that a wheel's turn makes, as a share: of slip and radius together. Of "
       "slip between 0 and 5 % 1.5 %, of a radius known to 1.5 mm as much again in squares."},
      {"slip_noise", &slip_noise, "", MoreThan(0.0),
       "Sigma of the slip over a metre of the way, as a share: as the ground differs from metre to "
       "metre. As large as slip on sand itself."},
      {"side_slip_noise", &side_slip_noise, "", MoreThan(0.0),
       "Sigma of the motion across and off the direction of travel over a metre, as a share: as "
       "the slip along it."},
      {"imu_height_m", &imu_height_m, "m", AtLeast(0.0),
       "Height of the IMU above level ground where the rig file does not state the wheels: "
       "Katwijk's "
       "left camera is about 1.10 m above it, 0.557 m above the IMU."},
      {"contact_sigma_m", &contact_sigma_m, "m", MoreThan(0.0),
       "Sigma, along each axis, of the point on the ground that moves straight ahead in a turn. It "
       "is "
       "taken to lie below the IMU, or amid the unsteered wheels that the rig file states. A sixth "
       "of a rover's length."},
      {"travel_sigma_rad", &travel_sigma_rad, "rad", MoreThan(0.0),
       "Sigma of the direction of travel against the IMU's axes, up and sideways: how straight a "
       "unit is screwed on."},
      {"gyro_noise_radps", &gyro_noise_radps, "rad/s/sqrt(Hz)", MoreThan(0.0),
       "Noise density of the gyro. Katwijk's scatters by 0.005 rad/s at 125 Hz, at rest."},
      {"gyro_driving_noise_radps", &gyro_driving_noise_radps, "rad/s/sqrt(Hz)", MoreThan(0.0),
       "The same while the rover drives: it shakes, and a camera whose stamps are off by 50 ms, on "
       "a "
       "rover that sways by 0.04 rad/s, has turned by 2 mrad in between, anew with each image."},
      {"gyro_bias_sigma_radps", &gyro_bias_sigma_radps, "rad/s", MoreThan(0.0),
       "Sigma of the gyro's bias before the rover has stood still: a tenth of a degree per second, "
       "as data sheets of small units have it once warm."},
      {"gyro_walk_radps", &gyro_walk_radps, "rad/s/sqrt(s)", AtLeast(0.0),
       "By how much the gyro's bias wanders in a second: 20 degrees per hour in two minutes, as "
       "data "
       "sheets of small units have it."},
      {"gyro_scale_sigma", &gyro_scale_sigma, "", MoreThan(0.0),
       "Sigma of the gyro's scale: data sheets of calibrated units say 0.1 to 0.5 %."},
      {"inclinometer_sigma_rad", &inclinometer_sigma_rad, "rad", MoreThan(0.0),
       "Sigma of the inclination, averaged over a second: a rover that changes its speed by 0.1 "
       "m/s "
       "in that time errs by as much."},
      {"level_sigma_rad", &level_sigma_rad, "rad", MoreThan(0.0),
       "Sigma of the error that all inclinations share: bias and mounting of the inclinometer."},
      {"max_gap_s", &max_gap_s, "s", MoreThan(0.0).UpTo(1e6),
       "Rows that are missing for longer are a gap: wheels cannot bridge it, filter needs images "
       "there. Half a second, since a rover starts and stops in as much."},
      {"keyframe_step_m", &keyframe_step_m, "m", MoreThan(0.0),
       "Without images to choose them by, a keyframe is made where the rover has moved so far: a "
       "fifth of what its cameras see of the ground."},
      {"keyframe_turn_rad", &keyframe_turn_rad, "rad", MoreThan(0.0),
       "Or has turned so far: a fifth of what its cameras see sideways."},
  };
}

OptionFields FilterOptions::Fields() {
  return {
      {"use_vision",
       &use_vision,
       "",
       {},
       "Whether the motion that the images show is used. Off: what the others are worth."},
      {"use_wheels", &use_wheels, "", {}, "Whether the wheels are used."},
      {"use_gyro", &use_gyro, "", {}, "Whether the gyro is used."},
      {"use_inclinometer",
       &use_inclinometer,
       "",
       {},
       "Whether the inclinometer is used, beside which way is up."},
      {"vision_scale_sigma", &vision_scale_sigma, "", MoreThan(0.0),
       "Sigma of the scale of visual motion that its covariance does not hold, as a share: 0.05 px "
       "of disparity that all points share, of the 17 px that LocCam sees the ground 6 m ahead "
       "with. "
       "That of the baseline, where the rig file states it, is counted in the verdict."},
      {"slip_sigmas", &slip_sigmas, "sigmas", MoreThan(0.0),
       "Where the wheels' and the images' way differ by more, along it, the wheels are taken to "
       "slip. "
       "Normal errors do so in three of a thousand steps, and lose little by it."},
      {"max_innovation_sigmas", &max_innovation_sigmas, "sigmas", MoreThan(0.0),
       "Where the motions differ by more (root mean square of six numbers) even if the wheels "
       "slip, "
       "the images mislead: normal errors do so once in a billion steps."},
      {"burst_slip", &burst_slip, "", MoreThan(0.0),
       "Sigma of the way between two frames, as a share, while the wheels slip: all of it."},
      {"unknown_speed_mps", &unknown_speed_mps, "m/s", MoreThan(0.0),
       "Sigma of the change of speed where no wheel tells it: the speed of a rover."},
      {"unknown_turn_radps", &unknown_turn_radps, "rad/s", MoreThan(0.0),
       "Sigma of the turn rate where no gyro tells it: a rover on a circle of two metres."},
  };
}

}  // namespace rigmap
