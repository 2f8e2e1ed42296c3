#include "dense/internal/coarse_to_fine.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "dense/internal/semi_global.h"
#include "dense/internal/winner.h"

namespace rigmap {
namespace {

// Images this small are searched over the whole range: entries of the cost volume.
constexpr double kSmallVolume = 4e6;
constexpr int kLeastSide = 64;  // px; of what is halved
// Views and disparities of all levels, and what OpenCV's filters take.
constexpr std::size_t kImageBytesPerPixel = 32;

// Of cost volumes, where windows allow: 48 disparities a pixel, or a small image as a whole.
std::size_t VolumeBytes(std::size_t pixels) {
  constexpr std::size_t kBytesPerPixel = 96;
  return std::max(static_cast<std::size_t>(12 * kSmallVolume), kBytesPerPixel * pixels);
}

cv::Mat Halved(const cv::Mat& view) {
  cv::Mat half;
  cv::resize(view, half, {view.cols / 2, view.rows / 2}, 0.0, 0.0, cv::INTER_AREA);
  return half;
}

// Finer things are seen with smaller blocks, and whatever is not seen here is lost: of the speckles
// that the next level drops, only those of a quarter of their size are dropped.
DenseOptions OptionsAtHalf(const DenseOptions& options) {
  DenseOptions half = options;
  half.block_px = std::min(options.block_px, 3);
  half.speckle_size_px = options.speckle_size_px / 16;
  return half;
}

struct Search {
  double whole_volume = 0.0;     // searched as a whole up to here, entries
  std::size_t volume_bytes = 0;  // of cost volumes

  cv::Mat Match(const cv::Mat& left, const cv::Mat& right, double range_px,
                const DenseOptions& options) const {
    const TileWindows windows = WindowsOf(left, right, range_px, options);
    cv::Mat disparity = MatchSemiGlobal(left, right, windows, options, volume_bytes);
    cv::medianBlur(disparity, disparity, 3);
    cv::filterSpeckles(disparity, WinnerRow::kNoDisparity, options.speckle_size_px,
                       options.speckle_step_px * WinnerRow::kSteps);
    return disparity;
  }

  TileWindows WindowsOf(const cv::Mat& left, const cv::Mat& right, double range_px,
                        const DenseOptions& options) const {
    const int range = static_cast<int>(std::ceil(range_px));
    const bool is_small = static_cast<double>(left.total()) * range_px <= whole_volume;
    if (is_small || std::min(left.cols, left.rows) < kLeastSide) {
      return WholeRange(left.size(), range);
    }
    const cv::Mat at_half =
        Match(Halved(left), Halved(right), range_px / 2.0, OptionsAtHalf(options));
    return WindowsAround(at_half, left.size()).value_or(WholeRange(left.size(), range));
  }
};

}  // namespace

cv::Mat MatchCoarseToFine(const cv::Mat& left, const cv::Mat& right, double range_px,
                          const DenseOptions& options) {
  const Search search{
      .whole_volume = std::max(kSmallVolume, kWholeSearch * static_cast<double>(left.total())),
      .volume_bytes = VolumeBytes(left.total())};
  const double most_px = WinnerRow::kMostDisparity;
  return search.Match(left, right, std::min(range_px, most_px), options);
}

std::size_t CoarseToFineBytes(cv::Size size, double range_px, const DenseOptions& options) {
  const std::size_t pixels = size.area();
  const TileWindows whole = WholeRange(size, static_cast<int>(std::ceil(range_px)));
  return kImageBytesPerPixel * pixels + SemiGlobalBytes(whole, options, VolumeBytes(pixels));
}

}  // namespace rigmap
