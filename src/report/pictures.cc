#include "report/pictures.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "imaging/picture.h"
#include "report/base64.h"

namespace rigmap {

std::string PictureUrl(const std::filesystem::path& path, int side_px, int quality) {
  try {
    cv::Mat image = ReadPicture(path);
    if (image.empty()) return "";
    // Of 16 bits cameras use 10, 12 or all.
    if (image.depth() != CV_8U) cv::normalize(image, image, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
    const double factor = std::min(1.0, double(side_px) / std::max(image.cols, image.rows));
    if (factor < 1.0) cv::resize(image, image, {}, factor, factor, cv::INTER_AREA);
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return "data:image/jpeg;base64," + Base64(bytes);
  } catch (const cv::Exception&) {
    return "";
  }
}

std::map<StampNs, std::string> Thumbnails(const std::map<StampNs, std::filesystem::path>& images,
                                          const std::set<StampNs>& wanted) {
  const std::size_t every = images.size() / (kMostThumbnails + 1) + 1;
  const std::size_t count = (images.size() + every - 1) / every;
  const int side_px = count <= 100 ? 480 : count <= 250 ? 320 : 240;
  std::vector<std::pair<StampNs, std::filesystem::path>> taken;
  std::size_t index = 0;
  for (const auto& image : images) {
    if (index++ % every == 0 || wanted.contains(image.first)) taken.emplace_back(image);
  }
  std::vector<std::string> urls(taken.size());
  oneapi::tbb::parallel_for(std::size_t{0}, taken.size(), [&](std::size_t i) {
    urls[i] = PictureUrl(taken[i].second, side_px, 72);
  });
  std::map<StampNs, std::string> thumbnails;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (!urls[i].empty()) thumbnails.emplace(taken[i].first, std::move(urls[i]));
  }
  return thumbnails;
}

std::string ColouredPictureUrl(const std::vector<double>& shares, int columns) {
  const int rows = static_cast<int>(shares.size()) / columns;
  cv::Mat grey(rows, columns, CV_8U), seen(rows, columns, CV_8U), colours;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double share = shares[static_cast<std::size_t>(row * columns + column)];
      grey.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(255.0 * share);
      seen.at<std::uint8_t>(row, column) = share < 0.0 ? 0 : 255;
    }
  }
  cv::applyColorMap(grey, colours, cv::COLORMAP_VIRIDIS);
  cv::cvtColor(colours, colours, cv::COLOR_BGR2BGRA);
  cv::insertChannel(seen, colours, 3);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", colours, bytes);
  return "data:image/png;base64," + Base64(bytes);
}

}  // namespace rigmap
