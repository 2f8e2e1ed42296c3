#include "fusion/internal/past_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kColumns = 256;  // of blocks; two pixels of 512 make one, and 16 of 4000

int SideOfBlocks(const DepthMap& map) { return (map.disparity.cols + kColumns - 1) / kColumns; }

// How much brighter what was lit is than its shade, in an image's values: a sun that gives two
// thirds of the light makes 1.6. Lenses shade the edges of images by up to a quarter.
const float kLogShade = std::log(1.3F);
const float kLogEdge = std::log(1.1F);  // of what lies beside a shade
constexpr int kShadeBlocks = 5;         // what is smaller by itself is an edge seen from elsewhere
constexpr int kEdgeBlocks = 7;          // a shade and its edges, twice three and one

// Of what the light makes of a spot most comes at once, when the shadow's edge passes. The rest may
// come by and by, as with lenses that shade the edges of images.
constexpr float kAtOnce = 0.6F;
constexpr std::size_t kFewest = 4;  // of few steps one is always most of what all make
// Of the median of the image's colours. What is dark by itself, as a rock, seems lighter from afar
// by what the lens scatters.
constexpr float kLeastLight = 0.2F;

// Of the frames before, every third is asked, twelve in all: as far back as ground is seen.
constexpr std::size_t kAsked = 12, kStride = 3, kKept = kAsked * kStride;
constexpr double kStep = 0.05;  // of the median depth, from one that is kept to the next

// A surface looked at twice has the same disparity to some sigmas of the two, and to what the slope
// of level ground makes over a block.
constexpr double kSigmas = 3.0, kSlope = 0.03;

float GreyOf(const cv::Vec3f& bgr) { return bgr[0] + bgr[1] + bgr[2]; }

// Blocks that are known throughout.
DepthView BlocksOf(const DepthView& view, double brightness) {
  const DepthMap& map = view.map;
  const int side_px = SideOfBlocks(map);
  const cv::Size size = map.disparity.size() / side_px;
  const cv::Rect whole(cv::Point(), size * side_px);
  DepthView blocks{map, view.world_from_rectified};
  blocks.map.camera.width = size.width;
  blocks.map.camera.height = size.height;
  for (double* value : {&blocks.map.camera.fx, &blocks.map.camera.fy}) *value /= side_px;
  for (double* value : {&blocks.map.camera.cx, &blocks.map.camera.cy}) {
    *value = (*value - 0.5 * (side_px - 1)) / side_px;
  }
  cv::Mat known, colour;
  cv::resize(map.disparity(whole) > 0.0F, known, size, 0.0, 0.0, cv::INTER_AREA);
  cv::resize(map.disparity(whole), blocks.map.disparity, size, 0.0, 0.0, cv::INTER_AREA);
  blocks.map.disparity /= side_px;
  blocks.map.disparity.setTo(0.0F, known < 255);
  cv::resize(map.colour(whole), colour, size, 0.0, 0.0, cv::INTER_AREA);
  colour.convertTo(blocks.map.colour, CV_32FC3, brightness);
  cv::resize(map.disparity_sigma(whole), blocks.map.disparity_sigma, size, 0.0, 0.0,
             cv::INTER_AREA);
  blocks.map.disparity_sigma /= side_px;
  blocks.map.smoothed_pct.release();
  return blocks;
}

struct Seen {
  std::array<cv::Vec3f, kAsked> colours;
  std::size_t count = 0;

  std::span<cv::Vec3f> Colours() { return {colours.data(), count}; }
};

// What the frames before saw of a block, latest first.
Seen SeenBefore(const DepthView& blocks, cv::Point at, const std::vector<const DepthView*>& before,
                const std::vector<Rigid3>& before_from_view) {
  const DepthMap& map = blocks.map;
  const float disparity_px = map.disparity.at<float>(at);
  if (!(disparity_px > 0.0F)) return {};
  const double own_sigma_px = map.disparity_sigma.at<float>(at);
  const Eigen::Vector3d x = map.PointInRectified(at.x, at.y, disparity_px);
  Seen seen;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const DepthMap& other = before[i]->map;
    const Eigen::Vector3d x_there = before_from_view[i] * x;
    const auto pixel = other.PixelOf(x_there);
    if (!pixel) continue;
    const float found_px = other.disparity.at<float>(*pixel);
    if (!(found_px > 0.0F)) continue;
    const double expected_px = other.camera.fx * other.baseline_m / x_there.z();
    const double sigma_px = std::hypot(other.disparity_sigma.at<float>(*pixel),
                                       expected_px / disparity_px * own_sigma_px);
    if (std::abs(found_px - expected_px) > kSigmas * sigma_px + kSlope * expected_px) continue;
    seen.colours[seen.count++] = other.colour.at<cv::Vec3f>(*pixel);
  }
  return seen;
}

// Natural logarithms of a block's colours in the light, the upper quartile of what was seen before,
// over those in its shade. Zero where too few saw it, or it did not come into a shade.
cv::Vec3f LogLight(const cv::Vec3f& own, std::span<cv::Vec3f> seen, float median_grey) {
  if (seen.size() < kFewest) return {};
  float most_at_once = 0.0F, last = GreyOf(own);
  for (const cv::Vec3f& colour : seen) {
    most_at_once = std::max(most_at_once, GreyOf(colour) - last);
    last = GreyOf(colour);
  }
  std::ranges::sort(seen, std::greater{}, GreyOf);
  const cv::Vec3f& lit = seen[std::max<std::size_t>(1, seen.size() / 4)];
  const float light = GreyOf(lit) - GreyOf(own);
  if (light < kLeastLight * median_grey || most_at_once < kAtOnce * light) return {};
  cv::Vec3f log_light;
  for (int i = 0; i < 3; ++i) log_light[i] = std::log((lit[i] + 1.0F) / (own[i] + 1.0F));
  return log_light;
}

float MedianGrey(const DepthMap& blocks) {
  std::vector<double> greys;
  for (int row = 0; row < blocks.colour.rows; ++row) {
    for (int column = 0; column < blocks.colour.cols; ++column) {
      if (!(blocks.disparity.at<float>(row, column) > 0.0F)) continue;
      greys.push_back(GreyOf(blocks.colour.at<cv::Vec3f>(row, column)));
    }
  }
  return greys.empty() ? 0.0F : static_cast<float>(Median(std::move(greys)));
}

// Of a mask what hangs together, at corners, too, with a part of it.
cv::Mat ConnectedWith(const cv::Mat& part, const cv::Mat& mask) {
  cv::Mat labels;
  const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
  std::vector<char> is_kept(static_cast<std::size_t>(count), 0);
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      if (part.at<uchar>(row, column)) is_kept.at(labels.at<int>(row, column)) = 1;
    }
  }
  is_kept.front() = 0;  // what is not in the mask
  cv::Mat kept(mask.size(), CV_8UC1);
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      kept.at<uchar>(row, column) = is_kept[labels.at<int>(row, column)] ? 255 : 0;
    }
  }
  return kept;
}

cv::Mat Ones(int blocks) { return cv::Mat::ones(blocks, blocks, CV_8UC1); }

// Blocks in a shade, 255; `log_light` by block. With a wide one goes what is thin and hangs
// together with it, as a mast's shadow with that of the rover.
cv::Mat ShadeOf(const cv::Mat& log_light) {
  cv::Mat mean, wide, around;
  cv::transform(log_light, mean, cv::Matx13f(1.0F / 3.0F, 1.0F / 3.0F, 1.0F / 3.0F));
  const cv::Mat dark = mean >= kLogShade;
  cv::morphologyEx(dark, wide, cv::MORPH_OPEN, Ones(kShadeBlocks));
  cv::dilate(ConnectedWith(wide, dark), around, Ones(kEdgeBlocks));
  return around & (mean >= kLogEdge);
}

// Natural logarithms of the light by block; nothing where too few frames were before.
std::optional<cv::Mat> LogLightOf(const DepthView& blocks, const std::deque<DepthView>& past) {
  std::vector<const DepthView*> before;
  std::vector<Rigid3> before_from_view;
  for (std::size_t i = 0; i < past.size(); i += kStride) {
    before.push_back(&past[i]);
    before_from_view.push_back(past[i].world_from_rectified.Inverse() *
                               blocks.world_from_rectified);
  }
  if (before.size() < kFewest) return std::nullopt;
  const float median_grey = MedianGrey(blocks.map);
  cv::Mat log_light(blocks.map.disparity.size(), CV_32FC3);
  tbb::parallel_for(tbb::blocked_range<int>(0, log_light.rows), [&](const auto& range) {
    for (int row = range.begin(); row < range.end(); ++row) {
      for (int column = 0; column < log_light.cols; ++column) {
        const cv::Point at(column, row);
        Seen seen = SeenBefore(blocks, at, before, before_from_view);
        log_light.at<cv::Vec3f>(at) =
            LogLight(blocks.map.colour.at<cv::Vec3f>(at), seen.Colours(), median_grey);
      }
    }
  });
  return log_light;
}

// Colours times the light of the blocks in a shade, as smooth as blocks are.
cv::Mat Lightened(const cv::Mat& colour, const cv::Mat& log_light, const cv::Mat& shade,
                  int side_px) {
  cv::Mat smooth = log_light.clone(), share, factor;
  smooth.setTo(cv::Scalar::all(0.0), ~shade);
  cv::blur(smooth, smooth, {3, 3});
  shade.convertTo(share, CV_32FC1, 1.0 / 255.0);
  cv::blur(share, share, {3, 3});
  cv::cvtColor(share, share, cv::COLOR_GRAY2BGR);
  cv::divide(smooth, share + cv::Scalar::all(1e-6), smooth);
  smooth.setTo(cv::Scalar::all(0.0), ~shade);
  cv::resize(smooth, factor, smooth.size() * side_px, 0.0, 0.0, cv::INTER_LINEAR);
  cv::exp(factor, factor);
  cv::Mat lit = colour.clone();
  cv::Mat of_blocks = lit(cv::Rect(cv::Point(), factor.size()));
  cv::multiply(of_blocks, factor, of_blocks, 1.0, CV_8UC3);
  return lit;
}

}  // namespace

cv::Mat PastLight::Lit(const DepthView& view, double brightness) {
  DepthView blocks = BlocksOf(view, brightness);
  const auto log_light = LogLightOf(blocks, past_);
  Remember(std::move(blocks));
  if (!log_light) return view.map.colour;
  const cv::Mat shade = ShadeOf(*log_light);
  if (cv::countNonZero(shade) == 0) return view.map.colour;
  return Lightened(view.map.colour, *log_light, shade, SideOfBlocks(view.map));
}

void PastLight::Remember(DepthView blocks) {
  std::vector<double> depths_m;
  for (const float disparity_px : cv::Mat_<float>(blocks.map.disparity)) {
    if (disparity_px > 0.0F) depths_m.push_back(blocks.map.Depth(disparity_px));
  }
  if (depths_m.empty()) return;
  if (!past_.empty()) {
    const Eigen::Vector3d step =
        blocks.world_from_rectified.translation - past_.front().world_from_rectified.translation;
    if (step.norm() < kStep * Median(std::move(depths_m))) return;
  }
  past_.push_front(std::move(blocks));
  if (past_.size() > kKept) past_.pop_back();
}

}  // namespace rigmap
