// The depth that one stereo frame shows, as disparities of its rectified left view.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "core/stamp.h"
#include "geometry/camera.h"
#include "geometry/rigid3.h"

namespace rigmap {

// Disparities are kept rather than depths: they are what was measured, and a plane is an affine
// function of the pixel in them.
inline constexpr float kUnsurePx = 1.0F;
struct DepthMap {
  StampNs stamp_ns = 0;
  Camera camera;               // of the rectified left view: a pinhole, fx == fy
  Rigid3 left_from_rectified;  // a rotation only
  double baseline_m = 0.0;
  cv::Mat disparity;  // CV_32FC1, px; 0: unknown
  // CV_32FC1, px; one standard deviation of each known disparity, kUnsurePx where it may be that of
  // something beside.
  cv::Mat disparity_sigma;
  // CV_8UC1: how many per cent of that sigma's square are what smoothing may have taken off the
  // surface, which frames that see it from elsewhere have in common. Empty: none.
  cv::Mat smoothed_pct;
  cv::Mat colour;  // CV_8UC3, BGR; anything where the disparity is unknown

  // z in rectified axes, metres, of a known disparity (> 0); and its standard deviation
  // z^2 / (f b) sigma_d.
  double Depth(double disparity_px) const { return camera.fx * baseline_m / disparity_px; }
  double DepthSigma(double disparity_px, double sigma_px) const {
    return Depth(disparity_px) * sigma_px / disparity_px;
  }
  // The point seen at a pixel of known disparity.
  Eigen::Vector3d PointInRectified(double column, double row, double disparity_px) const {
    return baseline_m / disparity_px *
           Eigen::Vector3d(column - camera.cx, row - camera.cy, camera.fx);
  }
  // The nearest pixel to where a point would be seen; nothing outside the image or behind it.
  std::optional<cv::Point> PixelOf(const Eigen::Vector3d& x_in_rectified) const {
    const Eigen::Vector3d& x = x_in_rectified;
    if (x.z() <= 0.0) return std::nullopt;
    const double scale = camera.fx / x.z();
    const cv::Point pixel(cvRound(scale * x.x() + camera.cx), cvRound(scale * x.y() + camera.cy));
    if (!cv::Rect(cv::Point(), disparity.size()).contains(pixel)) return std::nullopt;
    return pixel;
  }
};

// Median of the map's disparity less that of sparse points (left camera axes, metres) that fall on
// a known pixel. Points further than kMaxBiasPx off look at something else (an occlusion, a wrong
// match) and do not count. Nothing with fewer than kMinBiasPoints.
inline constexpr double kMaxBiasPx = 3.0;
inline constexpr int kMinBiasPoints = 20;
std::optional<double> DisparityBiasPx(const DepthMap& map,
                                      std::span<const Eigen::Vector3d> x_in_left);

// An artefact (core/artefact.h) with disparities in steps of 1/64 px (coarser where any is 1024 px
// or more), their sigmas in steps of 1/128 px (up to 2 px) and colours of known pixels, compressed
// without loss: 2 to 3 MB for 1024 x 768.
void SaveDepth(const std::filesystem::path& path, const std::string& key, const DepthMap& map);
// Nothing if there is no map with this key.
std::optional<DepthMap> LoadDepth(const std::filesystem::path& path, const std::string& key);
// The same, where it has to be there: throws DataError if it is not.
DepthMap ReadDepth(const std::filesystem::path& path, const std::string& key);

}  // namespace rigmap
