// A depth map from a stereo frame.
#pragma once

#include "dense/dense_options.h"
#include "imaging/depth_map.h"
#include "imaging/mask.h"
#include "imaging/rectifier.h"
#include "scene/dataset.h"

namespace rigmap {

// Holds what is the same for all frames of a rig: rectification maps and static masks.
// Immutable; Compute may be called from several threads.
class DenseMatcher {
 public:
  // `nearest_m`: what is nearer is not searched for. `left_mask`: pixels of the left image that may
  // be used in any frame (CV_8UC1, 255 or 0; empty: all), besides what the rig itself says. Throws
  // UsageError for invalid options, DataError for a rig whose masks cannot be read.
  DenseMatcher(const StereoRig& rig, double nearest_m, const DenseOptions& options,
               const MaskOptions& mask_options, const cv::Mat& left_mask = {});

  // Reads both images, rectifies, matches, refines and keeps what is usable and known well enough,
  // no further away than max_range_m. `right_turn`: of the right eye in this frame
  // (Adjustment::right_turns). Throws DataError for images that cannot be read.
  DepthMap Compute(const StereoFrame& frame,
                   const Eigen::Vector3d& right_turn = Eigen::Vector3d::Zero()) const;

  double nearest_m() const { return nearest_m_; }
  // At most what one call of Compute takes, its result included, megabytes.
  double MegabytesPerFrame() const;
  double MegabytesPerView() const;  // of a depth map

 private:
  DepthMap Compute(const StereoFrame& frame, const Rectifier& rectifier) const;
  cv::Mat UsableForDepth(const cv::Mat& grey, const cv::Mat& static_mask) const;
  double NearestPx() const;  // disparity of what is nearest

  StereoRig rig_;
  double nearest_m_;
  DenseOptions options_;
  MaskOptions mask_options_;
  Rectifier rectifier_;
  cv::Mat left_static_, right_static_;
};

}  // namespace rigmap
