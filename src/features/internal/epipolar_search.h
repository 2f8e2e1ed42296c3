// Coarse search for a window along its epipolar curve in the other eye's image.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "geometry/camera.h"
#include "geometry/rigid3.h"

namespace rigmap {

struct EpipolarMatch {
  Eigen::Vector2d pixel;       // in the target image, full resolution, to about one search pixel
  double inverse_depth = 0.0;  // 1/m, along the source camera's z
  double correlation = 0.0;    // zero-mean normalised
  double runner_up = -1.0;     // best correlation elsewhere on the curve
};

// Searches windows of `source` in `target`, both at full resolution / `reduction`.
class EpipolarSearch {
 public:
  struct Side {
    cv::Mat image;  // CV_8UC1, reduced
    Camera camera;  // of the full-resolution image
  };
  struct Range {
    double max_inverse_depth = 0.0;  // 1/m
    double band_px = 0.0;            // half height around the curve, full resolution
  };

  EpipolarSearch(Side source, Side target, const Rigid3& target_from_source, int reduction);

  // `pixel` is full resolution. Nothing where the window leaves the image.
  std::optional<EpipolarMatch> Find(const Eigen::Vector2d& pixel, const Range& range) const;

  // Where a point seen at `normalised` at 1 / inverse_depth appears in the target.
  Eigen::Vector2d Transfer(const Eigen::Vector2d& normalised, double inverse_depth) const;

 private:
  // Of the window around each pixel (CV_32S, CV_32F); zero where it leaves the image. The second is
  // one over the root of the sum of squared differences from the mean; zero for a flat window, too.
  struct WindowStatistics {
    cv::Mat sum, inverse_deviation;
  };
  struct SourceWindow;

  static WindowStatistics StatisticsOf(const cv::Mat& image);
  SourceWindow WindowAt(const cv::Point& at) const;
  double Correlation(const SourceWindow& window, const cv::Point& target_at) const;

  Side source_, target_;
  WindowStatistics source_statistics_, target_statistics_;
  Rigid3 target_from_source_;
  int reduction_;
};

}  // namespace rigmap
