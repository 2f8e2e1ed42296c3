// The calibration of a stereo rig as a YAML file.
//
//   left, right:       model: PINHOLE | OPENCV | FULL_OPENCV
//                      width, height          pixels
//                      fx, fy, cx, cy         pixels; the centre of the first pixel is (0, 0)
//                      distortion             [k1, k2, p1, p2]; may be left out for PINHOLE; of
//                                             FULL_OPENCV [k1, k2, p1, p2, k3, k4, k5, k6] with
//                                             k4 to k6 of 0, or its first five numbers
//                      calibrated_region      optional [x0, y0, x1, y1], pixels, inclusive
//                      mask                   optional image, path relative to this file;
//                                             where it is 0 the eye is not used
//   right_from_left:   R: 9 numbers, row by row, t: 3 numbers, metres; x_right = R x_left + t
//   baseline_m         optional, |t| in metres, to 1e-6 m
//   rectified          optional; true promises R = 1 and t along -x, each to 1e-3 rad
//   antenna_in_left    optional [x, y, z], metres, left camera axes
//   imu_from_left      optional {R, t}, as above
//   wheels             optional, of a rover with six drives and four steering joints, in the order
//                      of scene/rover_sensors.h: contacts_in_imu  18 numbers, where each wheel
//                             touches level ground, metres, IMU axes
//                      steered_by       6 numbers: its steering joint 1 to 4; 0: none
//                      radius_m         optional
//   sigmas             optional: baseline_m, one standard deviation of the baseline's length; and
//                      either rotation_deg, focal_pct, aspect_pct, principal_point_px,
//                      distortion_px, board_px, each optional (RigSigmas of scene/rig.h), or
//                      covariance, that of a correction of this rig (scene/calibration.h), 190
//                      numbers: the upper triangle, row by row
//   pool               optional, written by `rigmap calibrate` (scene/rig_pool.h):
//                      start  the rig before any part was seen, with the keys above
//                      parts  a list: frames, keys of the part's frames (DatasetContent::images)
//                             with blanks between; of the rig as all other parts tell it the
//                             correction of start, 19 numbers, and the covariance, as above
#pragma once

#include <filesystem>
#include <string>

#include "scene/rig.h"
#include "scene/rig_pool.h"

namespace rigmap {

// Throws DataError naming file, line, what was expected and what was found: for any other key,
// fisheye models and k4 to k6 (by name), numbers that are not finite, R further than 1e-3 from a
// rotation (closer ones are made exact), a principal point outside the image, a right camera that
// is not to the right of the left one. A calibrated_region is cut to the image. Whether masks exist
// is asked by who needs their pixels (OpenDataset).
StereoRig ReadRigFile(const std::filesystem::path& path);

// The same of a text; `name` is what errors call it, and what relative paths are relative to.
StereoRig ParseRigFile(const std::string& text, const std::filesystem::path& name);

// Text that ReadRigFile reads back to the same rig (rotations to rounding).
std::string WriteRigFile(const StereoRig& rig);

// These three with the file's pool, if it has one.
PooledRig ReadPooledRigFile(const std::filesystem::path& path);
PooledRig ParsePooledRigFile(const std::string& text, const std::filesystem::path& name);
std::string WritePooledRigFile(const PooledRig& rig);

}  // namespace rigmap
