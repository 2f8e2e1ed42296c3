#include "features/corner_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

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

struct ImagePair {
  const cv::Mat &from, &to;
};

// Where corners are that were followed to near `expected`, and back to where they began.
std::vector<std::optional<cv::Point2f>> FollowThereAndBack(const ImagePair& images,
                                                           const std::vector<cv::Point2f>& from,
                                                           const std::vector<cv::Point2f>& expected,
                                                           const CornerOptions& options) {
  const cv::Size window(options.window_px, options.window_px);
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  std::vector<cv::Point2f> there = expected, back = from;
  std::vector<std::uint8_t> is_there, is_back;
  std::vector<float> errors;
  const auto follow = [&](const cv::Mat& a, const cv::Mat& b, const std::vector<cv::Point2f>& start,
                          std::vector<cv::Point2f>& end, std::vector<std::uint8_t>& is_found) {
    cv::calcOpticalFlowPyrLK(a, b, start, end, is_found, errors, window, options.pyramid_levels,
                             enough, cv::OPTFLOW_USE_INITIAL_FLOW);
  };
  follow(images.from, images.to, from, there, is_there);
  // As far off as the way there was, not from where it has to end.
  for (std::size_t i = 0; i < back.size(); ++i) back[i] = there[i] + (from[i] - expected[i]);
  follow(images.to, images.from, there, back, is_back);
  std::vector<std::optional<cv::Point2f>> found(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const bool is_sure =
        is_there[i] && is_back[i] && cv::norm(back[i] - from[i]) <= options.max_round_trip_px;
    if (is_sure) found[i] = there[i];
  }
  return found;
}

// The homography that most corners moved by: ground is a plane, more or less. Empty where too few
// agree, as of those that are found by chance.
cv::Mat GroundMotion(const std::vector<cv::Point2f>& from,
                     const std::vector<std::optional<cv::Point2f>>& to) {
  constexpr int kLeast = 20;
  constexpr double kOff_px = 5.0;  // of what is no plane; the search takes the rest up
  std::vector<cv::Point2f> a, b;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!to[i]) continue;
    a.push_back(from[i]);
    b.push_back(*to[i]);
  }
  const int found = static_cast<int>(a.size());
  if (found < kLeast) return {};
  cv::Mat agree;
  cv::Mat motion = cv::findHomography(a, b, cv::RANSAC, kOff_px, agree);
  if (motion.empty() || cv::countNonZero(agree) < std::max(kLeast, found / 2)) return {};
  return motion;
}

// Once more those that have not been found, from where the motion takes them; none without one.
void FollowLost(const ImagePair& images, const std::vector<cv::Point2f>& from,
                const cv::Mat& motion, const CornerOptions& options,
                std::vector<std::optional<cv::Point2f>>& there) {
  std::vector<std::size_t> lost;
  std::vector<cv::Point2f> lost_from, expected;
  for (std::size_t i = 0; i < there.size(); ++i) {
    if (there[i]) continue;
    lost.push_back(i);
    lost_from.push_back(from[i]);
  }
  if (lost.empty() || motion.empty()) return;
  cv::perspectiveTransform(lost_from, expected, motion);
  const auto again = FollowThereAndBack(images, lost_from, expected, options);
  for (std::size_t k = 0; k < lost.size(); ++k) there[lost[k]] = again[k];
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

CornerTracker::Corners CornerTracker::Follow(const cv::Mat& grey, const cv::Mat& mask) {
  Corners found;
  if (last_.pixels.empty() || last_grey_.empty()) return found;
  const ImagePair images{last_grey_, grey};
  auto there = FollowThereAndBack(images, last_.pixels, last_.pixels, options_);
  // Few that are found, by chance, may agree on another motion than the ground's.
  FollowLost(images, last_.pixels, GroundMotion(last_.pixels, there), options_, there);
  FollowLost(images, last_.pixels, last_motion_, options_, there);
  last_motion_ = GroundMotion(last_.pixels, there);
  for (std::size_t i = 0; i < there.size(); ++i) {
    if (!there[i] || !IsUsable(mask, *there[i])) continue;
    found.pixels.push_back(*there[i]);
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
    last_motion_.release();
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
        FeatureOf(pixels[i], matches.found[i], static_cast<float>(options_.window_px)));
  }
  result.tracks = corners.tracks;
  result.epipolar_errors_px = std::move(matches.epipolar_errors_px);
  result.usable_share = cv::countNonZero(mask) / static_cast<double>(mask.total());
  last_ = std::move(corners);
  last_grey_ = smooth;
  return result;
}

}  // namespace rigmap
