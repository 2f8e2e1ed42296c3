#include "features/corner_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "features/internal/grey_pair.h"
#include "features/stereo_matches.h"

namespace rigmap {
namespace {

// Corners as far apart as makes `count` of them fill the image evenly.
double SpacingPx(const cv::Mat& grey, int count) {
  constexpr double kPacking = 0.6;  // of the side of the square that each has for itself
  return kPacking * std::sqrt(static_cast<double>(grey.total()) / count);
}

bool IsUsable(const cv::Mat& mask, const cv::Point2f& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x)), y = static_cast<int>(std::lround(pixel.y));
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

}  // namespace

OptionFields CornerOptions::Fields() {
  return {
      {"max_corners", &max_corners, "", AtLeast(50).UpTo(50000),
       "Corners followed in each left image; as many as features.max_keypoints, for a fair "
       "comparison."},
      {"quality", &quality, "share of the best corner's", MoreThan(0.0).Below(1.0),
       "Least response of a corner (Shi and Tomasi). Low: on sand corners all over the image "
       "matter more than strong ones."},
      {"window_px", &window_px, "px", AtLeast(5).UpTo(101), "Side of the window that is followed."},
      {"pyramid_levels", &pyramid_levels, "", AtLeast(0).UpTo(8),
       "Halvings of the image. Five follow what moves by half of window_px times 32, more than "
       "anything a keyframe still sees."},
      {"max_round_trip_px", &max_round_trip_px, "px", MoreThan(0.0),
       "A corner followed back must end so near to where it began: some times the noise of 0.1 "
       "to 0.2 px that good tracks have."},
  };
}

CornerTracker::Corners CornerTracker::Follow(const cv::Mat& grey, const cv::Mat& mask) const {
  Corners found;
  if (last_.pixels.empty() || last_grey_.empty()) return found;
  const cv::Size window(options_.window_px, options_.window_px);
  std::vector<cv::Point2f> there, back;
  std::vector<std::uint8_t> is_there, is_back;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(last_grey_, grey, last_.pixels, there, is_there, errors, window,
                           options_.pyramid_levels);
  cv::calcOpticalFlowPyrLK(grey, last_grey_, there, back, is_back, errors, window,
                           options_.pyramid_levels);
  for (std::size_t i = 0; i < there.size(); ++i) {
    const double round_trip_px = cv::norm(back[i] - last_.pixels[i]);
    const bool is_sure = is_there[i] && is_back[i] && round_trip_px <= options_.max_round_trip_px;
    if (!is_sure || !IsUsable(mask, there[i])) continue;
    found.pixels.push_back(there[i]);
    found.tracks.push_back(last_.tracks[i]);
  }
  return found;
}

void CornerTracker::AddNew(const cv::Mat& grey, const cv::Mat& mask, Corners& corners) {
  const int wanted = options_.max_corners - static_cast<int>(corners.pixels.size());
  if (wanted <= 0) return;
  const double spacing_px = SpacingPx(grey, options_.max_corners);
  cv::Mat open = mask.clone();
  for (const cv::Point2f& pixel : corners.pixels) {
    cv::circle(open, pixel, static_cast<int>(spacing_px), cv::Scalar(0), cv::FILLED);
  }
  std::vector<cv::Point2f> fresh;
  cv::goodFeaturesToTrack(grey, fresh, wanted, options_.quality, spacing_px, open);
  for (const cv::Point2f& pixel : fresh) {
    corners.pixels.push_back(pixel);
    corners.tracks.push_back(next_track_++);
  }
}

FrameFeatures CornerTracker::Next(const StereoFrame& frame) {
  FrameFeatures result;
  result.stamp_ns = frame.stamp_ns;
  const auto images = ReadGreyPair(frame, setup_.rig, result.unreadable_images);
  if (!images) {
    result.usable_share = 0.0;
    last_ = {};
    last_grey_.release();
    return result;
  }
  const cv::Mat mask = UsableMask(images->left, setup_.left_mask, setup_.mask_options);
  const cv::Mat smooth = Smooth(images->left);
  Corners corners = Follow(smooth, mask);
  AddNew(smooth, mask, corners);
  std::vector<Eigen::Vector2d> pixels;
  for (const cv::Point2f& pixel : corners.pixels) pixels.emplace_back(pixel.x, pixel.y);
  StereoMatches matches =
      FindStereoMatches({smooth, Smooth(images->right),
                         UsableMask(images->right, setup_.right_mask, setup_.mask_options)},
                        setup_.rig, pixels, setup_.options);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    result.features.push_back(
        {pixels[i], matches.right[i], static_cast<float>(options_.window_px)});
  }
  result.tracks = corners.tracks;
  result.epipolar_errors_px = std::move(matches.epipolar_errors_px);
  result.usable_share = cv::countNonZero(mask) / static_cast<double>(mask.total());
  last_ = std::move(corners);
  last_grey_ = smooth;
  return result;
}

}  // namespace rigmap
