// Images from files, as the stages want them.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "geometry/camera.h"

namespace rigmap {

// Both read PNG, JPEG, PGM, PPM and TIFF of 8 or 16 bit, as the pixels lie in the file: orientation
// flags are ignored, because the calibration knows nothing of them. 16 bit are scaled by a fixed
// 1/256, so that brightness stays comparable between frames; a file whose largest value is below
// 4096 is taken as 12 bit and scaled by 1/16. An alpha channel is dropped.
//
// Throw DataError when the file cannot be opened or decoded, or is not of the camera's size.
// Thread-safe.

// CV_8UC1; colour is converted.
cv::Mat ReadGrey(const std::string& path, const Camera& camera);

// CV_8UC3, BGR; grey files give grey.
cv::Mat ReadColour(const std::string& path, const Camera& camera);

}  // namespace rigmap
