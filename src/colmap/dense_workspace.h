// The stereo part of COLMAP's undistorted workspace, from which its fusion and meshing go on.
//
//   images/NAME                             undistorted views
//   sparse/                                 their cameras, poses and points (colmap/model_io.h)
//   stereo/depth_maps/NAME.geometric.bin    float32, z in camera axes; 0: unknown
//   stereo/normal_maps/NAME.geometric.bin   three float32, towards the camera; 0: unknown
//
//   stereo/consistency_graphs/              empty
//
//   stereo/fusion.cfg                       a NAME a line
//
//   stereo/patch-match.cfg                  of each NAME two lines: itself, "__auto__, 20"
//
// A .bin is "WIDTH&HEIGHT&CHANNELS&" and then the values, little endian, row by row, a channel
// after the other. Its pixels are those of the image.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace rigmap {

struct StereoView {
  std::string name;  // of the image, relative to images/
  int width = 0, height = 0;
  std::span<const float> depth;    // width x height, row by row
  std::span<const float> normals;  // all x, then all y, then all z
};

// The two .bin files of a view. Throws DataError when one cannot be written.
void WriteStereoView(const StereoView& view, const std::filesystem::path& workspace);

// What names the views in stereo/, in their order. Throws DataError.
void WriteStereoLists(const std::vector<std::string>& names,
                      const std::filesystem::path& workspace);

}  // namespace rigmap
