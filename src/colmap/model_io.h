// COLMAP's binary model files: cameras.bin, images.bin, points3D.bin (little endian).
//
//   cameras.bin   u64 count; each: u32 id, i32 model, u64 width, u64 height, f64 parameters[]
//   images.bin    u64 count; each: u32 id, f64 qw qx qy qz tx ty tz (camera_from_model),
//                 u32 camera id, name and a zero byte, u64 keypoints; each: f64 x y, u64 point id
//                 (largest u64: none)
//   points3D.bin  u64 count; each: u64 id, f64 x y z, u8 r g b, f64 error, u64 track; each: u32
//                 image id, u32 keypoint
//
// Pixels in the files are COLMAP's, those of SparseModel OpenCV's. The left camera is 1, the right
// one 2; frame k's images are 2k + 1 (left) and 2k + 2 (right).
#pragma once

#include <filesystem>

#include "scene/sparse_model.h"

namespace rigmap {

// Everything in the order of the files. Throws DataError naming the file when it is missing,
// truncated, longer than it says, holds numbers that are not finite or names cameras, images or
// keypoints that do not exist, for cameras and images numbered otherwise than a rig's, and for
// camera models other than PINHOLE, OPENCV and FULL_OPENCV.
SparseModel ReadModel(const std::filesystem::path& folder);

// Creates the folder; each file is replaced as a whole, other files stay. Reading COLMAP's own
// model and writing it gives equal bytes. Throws DataError.
void WriteModel(const SparseModel& model, const std::filesystem::path& folder);

// True if the folder holds all three files.
bool HasModel(const std::filesystem::path& folder);

}  // namespace rigmap
