// rigmap's camera as COLMAP's camera models. The only place, with the keypoints of database.h and
// model_io.h, where OpenCV's pixel centres (at integers) and COLMAP's (at +0.5) meet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"

namespace rigmap {

// COLMAP's pixel = OpenCV's pixel + this, in x and y.
constexpr double kColmapPixelShift = 0.5;

struct ColmapCamera {
  int model = 0;  // 1 PINHOLE (fx fy cx cy), 4 OPENCV (fx fy cx cy k1 k2 p1 p2),
                  // 6 FULL_OPENCV (the same and k3 k4 k5 k6)
  std::vector<double> parameters;
};

ColmapCamera ToColmap(const Camera& camera);

// Number of parameters of the models that rigmap knows; nothing for any other.
std::optional<std::size_t> ParameterCount(int model);

// The inverse of ToColmap, of a model that rigmap knows and with all its parameters; k4 to k6,
// which only COLMAP gives to a free camera, are left out.
Camera FromColmap(const ColmapCamera& colmap_camera, int width, int height);

// "SIMPLE_RADIAL (2)", for messages about a model that rigmap does not know.
std::string ModelName(int model);

}  // namespace rigmap
