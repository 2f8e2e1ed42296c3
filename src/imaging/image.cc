#include "imaging/image.h"

#include <fmt/format.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"

namespace rigmap {
namespace {

cv::Mat Decode(const std::string& path, int flags) {
  if (!std::filesystem::is_regular_file(path)) {
    throw DataError(fmt::format("{}: expected an image file, found none", path));
  }
  cv::Mat image;
  try {
    image = cv::imread(path, flags | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) {
    throw DataError(fmt::format("{}: expected an image, but it cannot be decoded", path));
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw DataError(fmt::format("{}: expected an image of 8 or 16 bit, found {}", path,
                                cv::typeToString(image.type())));
  }
  return image;
}

cv::Mat ToEightBit(const cv::Mat& image) {
  if (image.depth() == CV_8U) return image;
  double largest = 0.0;
  cv::minMaxIdx(image.reshape(1), nullptr, &largest);
  cv::Mat eight_bit;
  image.convertTo(eight_bit, CV_8U, largest < 4096.0 ? 1.0 / 16.0 : 1.0 / 256.0);
  return eight_bit;
}

cv::Mat ReadEightBit(const std::string& path, const Camera& camera, int flags) {
  const cv::Mat image = Decode(path, flags);
  if (image.cols != camera.width || image.rows != camera.height) {
    throw DataError(fmt::format("{}: expected an image of {} x {} pixels, found {} x {}", path,
                                camera.width, camera.height, image.cols, image.rows));
  }
  return ToEightBit(image);
}

}  // namespace

cv::Mat ReadGrey(const std::string& path, const Camera& camera) {
  return ReadEightBit(path, camera, cv::IMREAD_GRAYSCALE);
}

cv::Mat ReadColour(const std::string& path, const Camera& camera) {
  return ReadEightBit(path, camera, cv::IMREAD_COLOR);
}

}  // namespace rigmap
