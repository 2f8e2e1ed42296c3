// Images to look at, of any size.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace rigmap {

// BGR, 8 or 16 bit as they are stored, an orientation in EXIF data ignored. Empty where the file
// cannot be read, is cut off, or is a damaged JPEG. May throw cv::Exception.
cv::Mat ReadPicture(const std::filesystem::path& path);

}  // namespace rigmap
