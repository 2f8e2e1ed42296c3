// Images from files, as the stages want them.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "core/error.h"
#include "geometry/camera.h"

namespace rigmap {

// An image file that is empty, cut off, damaged or something else: its frame shows nothing, but the
// other frames are as good as ever.
class UnreadableImage : public DataError {
 public:
  using DataError::DataError;
};

// True if the file is an image with its end in place, judged by its header and its length or end
// marker (microseconds; damage in between is not seen).
bool IsWholeImage(const std::filesystem::path& path);

// All read PNG, JPEG, PGM, PPM and TIFF of 8 or 16 bit, as the pixels lie in the file: orientation
// flags are ignored, because the calibration knows nothing of them. 16 bit are scaled by a fixed
// 1/256, so that brightness stays comparable between frames; a file whose largest value is below
// 4096 is taken as 12 bit and scaled by 1/16. An alpha channel is dropped.
//
// Throw UnreadableImage when there is a file that cannot be decoded or lacks its end, DataError
// when there is none or it is not of the camera's size. The size is taken from the header: a file
// that claims another takes no memory. Thread-safe.

// Width and height, from the header.
cv::Size ReadSize(const std::string& path);

// CV_8UC1; colour is converted.
cv::Mat ReadGrey(const std::string& path, const Camera& camera);

// CV_8UC3, BGR; grey files give grey.
cv::Mat ReadColour(const std::string& path, const Camera& camera);

}  // namespace rigmap
