// Corners followed from frame to frame by the tracker of Kanade, Lucas and Tomasi (OpenCV's), in
// place of keypoints that are found again by their descriptors.
#pragma once

#include "core/options.h"
#include "features/extract_features.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in corner_tracker.cc.
struct CornerOptions {
  static constexpr const char* kSection = "klt";

  int max_corners = 1500;
  double quality = 0.005;
  int window_px = 21;
  int pyramid_levels = 5;
  double max_round_trip_px = 0.5;

  OptionFields Fields();
};

// Frames one after the other. Holds the image of the last.
class CornerTracker {
 public:
  CornerTracker(FeatureSetup setup, const CornerOptions& options)
      : setup_(std::move(setup)), options_(options) {}

  // Corners that were followed from the frame before, then new ones where there are few; each with
  // its track and, where there is one, its stereo match. No descriptors and no patches. A frame
  // whose images cannot be decoded has no features and names the files, and all tracks end there.
  FrameFeatures Next(const StereoFrame& frame);

 private:
  struct Corners {
    std::vector<cv::Point2f> pixels;
    std::vector<std::int64_t> tracks;
  };
  // Of the last frame's corners those that are found in `grey` and lead back to where they were.
  // Those that are not are looked for once more where the ground's motion in the image, as the
  // others or else the frame before tell it, takes them.
  Corners Follow(const cv::Mat& grey, const cv::Mat& mask);
  void AddNew(const cv::Mat& grey, const cv::Mat& mask, Corners& corners);

  FeatureSetup setup_;
  CornerOptions options_;
  cv::Mat last_grey_;
  Corners last_;
  cv::Mat last_motion_;  // homography of the ground from the frame before the last; empty: unknown
  std::int64_t next_track_ = 0;
};

}  // namespace rigmap
