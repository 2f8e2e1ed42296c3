// Images from files, as the stages want them, and into files.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
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
// flags are ignored, because the calibration knows nothing of them. Values of 16 bit files are
// scaled to 8 bit by a fixed factor, 2^(8 - sample_bits), so that brightness stays comparable
// between frames: by 1/256, or by 1/16 where the part's files hold values of a 12 bit sensor. An
// alpha channel is dropped.
//
// Throw UnreadableImage when there is a file that cannot be decoded or lacks its end, DataError
// when there is none or it is not of the camera's size. The size is taken from the header: a file
// that claims another takes no memory. Thread-safe.

// Width and height, from the header.
cv::Size ReadSize(const std::string& path);

// CV_8UC1; colour is converted. `sample_bits`: 8 to 16; what is beyond gives 255.
cv::Mat ReadGrey(const std::string& path, const Camera& camera, int sample_bits = 16);

// CV_8UC3, BGR; grey files give grey.
cv::Mat ReadColour(const std::string& path, const Camera& camera, int sample_bits = 16);

// How many bits the values of a 16 bit file need, 10, 12, 14 or 16: 12 where the largest is from
// 1024 to 4095, as in those of a 12 bit sensor and in dark ones of 16 bit: one file does not tell
// which. Nothing for
// 8 bit files, known from the header alone, and for what cannot be decoded or is not of the
// camera's size. Thread-safe.
std::optional<int> SampleBitsNeeded(const std::string& path, const Camera& camera);

// A whole file in the format of the path's extension, in place at once. Throws DataError when it
// cannot be written.
void WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace rigmap
