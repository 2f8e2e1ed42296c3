// Options of the stages `dead_reckoning` and `filter`.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in dead_reckoning_options.cc.

// What is known of the rover and its sensors.
struct DeadReckoningOptions {
  static constexpr const char* kSection = "dead_reckoning";

  double wheel_radius_m = 0.123;
  double wheel_slip = 0.025;
  double wheel_scale_sigma = 0.02;
  double slip_noise = 0.03;
  double side_slip_noise = 0.03;
  double imu_height_m = 0.54;
  double contact_sigma_m = 0.1;
  double travel_sigma_rad = 0.01;
  double gyro_noise_radps = 0.0005;
  double gyro_driving_noise_radps = 0.002;
  double gyro_bias_sigma_radps = 0.002;
  double gyro_walk_radps = 0.00001;
  double gyro_scale_sigma = 0.003;
  double inclinometer_sigma_rad = 0.01;
  double level_sigma_rad = 0.005;
  double max_gap_s = 0.5;
  double keyframe_step_m = 0.2;
  double keyframe_turn_rad = 0.2;

  OptionFields Fields();
};

// How they are fused with what the images show.
struct FilterOptions {
  static constexpr const char* kSection = "filter";

  bool use_vision = true;
  bool use_wheels = true;
  bool use_gyro = true;
  bool use_inclinometer = true;
  double vision_scale_sigma = 0.003;
  double slip_sigmas = 3.0;
  double max_innovation_sigmas = 3.0;
  double burst_slip = 1.0;
  double unknown_speed_mps = 0.5;
  double unknown_turn_radps = 0.2;

  OptionFields Fields();
};

}  // namespace rigmap
