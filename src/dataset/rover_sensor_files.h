// The wheels and the inertial unit of a Katwijk part, as dead reckoning uses them.
//
// odometry.txt, a row: stamp; angle (rad), rate (rad/s) and an analogue value of six drives (three
// axles from the front to the rear, left before right) and of four steering joints (front left,
// front right, rear left, rear right); rocker, left and right bogie (rad): 34 fields. The analogue
// values and the last three are not used.
// imu.txt: see inclinometer.h. The first acceleration is not used.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

struct RoverSensorReading {
  WheelRecord wheels;
  InertialRecord inertial;
  // Why the columns of imu.txt, so its inclinometer too, are not to be believed; empty: they are.
  std::string inclinometer_problem;
  std::vector<std::string> remarks;  // on rows that were left out, and on gaps
};

// The rows from 30 s before the first frame, where a rover may stand still and its gyro tell its
// bias, to 2 s after the last. Rows that are malformed or repeat a stamp are left out with a
// remark. `problem` is set where there is no file or row that can be used, where the clock goes
// back, where the angles of the drives do not change as their rates say, where a steering joint
// goes round or a drive turns faster than a rover's can, and where the inclinometer does not show
// gravity: what columns that were exchanged lead to. A step far longer than usual while images were
// taken, as a clock leaves it that was set forwards, gets a remark. `frames`: increasing stamps,
// not empty.
RoverSensorReading ReadRoverSensors(const std::filesystem::path& part_folder,
                                    std::span<const StereoFrame> frames);

// Takes out of the drives' angles what jumps by full turns against the rates: a counter that starts
// anew with each turn, and where records begin that were unwrapped apart. `samples`: increasing
// stamps.
void UnwrapDriveAngles(std::vector<WheelSample>& samples);

}  // namespace rigmap
