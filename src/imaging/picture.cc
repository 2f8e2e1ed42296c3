#include "imaging/picture.h"

#include <opencv2/imgcodecs.hpp>

#include "imaging/image.h"
#include "imaging/internal/jpeg.h"

namespace rigmap {

cv::Mat ReadPicture(const std::filesystem::path& path) {
  // OpenCV decodes what is left of a file that was cut, and libjpeg says so on standard error.
  if (!IsWholeImage(path)) return {};
  if (const auto pixels = DecodeJpeg(path, false)) return *pixels;
  return cv::imread(path.string(),
                    cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
}

}  // namespace rigmap
