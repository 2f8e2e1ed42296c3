// Stereo matches of left keypoints in the right image.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "features/feature_options.h"
#include "features/keypoints.h"
#include "scene/features.h"
#include "scene/rig.h"

namespace rigmap {

// Grey images of both eyes (CV_8UC1) and the pixels of the right one that may be matched.
struct StereoImages {
  cv::Mat left, right;
  cv::Mat right_mask;
};

struct StereoMatch {
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  // px
  Eigen::Matrix2d right_from_left =
      Eigen::Matrix2d::Identity();  // how the window around it is stretched and sheared
};

struct StereoMatches {
  std::vector<std::optional<StereoMatch>> found;  // one entry per left keypoint
  std::vector<float> epipolar_errors_px;          // of all that were found, before rejection
};

// For each left keypoint: windows along its epipolar curve (in a band around it) are correlated
// with its own, the best position is refined to sub-pixel by affine alignment, and kept if it is
// unique, leads back to the keypoint, is claimed by no better keypoint and lies on the line.
StereoMatches FindStereoMatches(const StereoImages& images, const StereoRig& rig,
                                const std::vector<Eigen::Vector2d>& left_pixels,
                                const FeatureOptions& options);

// A keypoint with its match, if it has one.
Feature FeatureOf(const Eigen::Vector2d& left, const std::optional<StereoMatch>& match, float size);

// Signed distance (px of the right image) of a stereo match from its epipolar line: the difference
// of rectified rows. Nothing where a pixel has no ray.
std::optional<double> EpipolarErrorPx(const StereoRig& rig, const Eigen::Vector2d& left,
                                      const Eigen::Vector2d& right);

}  // namespace rigmap
