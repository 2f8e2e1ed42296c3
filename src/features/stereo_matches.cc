#include "features/stereo_matches.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/statistics.h"
#include "correspondence/patch_alignment.h"
#include "features/internal/epipolar_search.h"
#include "geometry/rectification.h"

namespace rigmap {
namespace {

struct Candidate {
  std::size_t keypoint = 0;
  StereoMatch match;
  double correlation = 0.0;
  double epipolar_error_px = 0.0;
};

cv::Mat Reduce(const cv::Mat& image, int reduction) {
  if (reduction == 1) return image;
  cv::Mat reduced;
  cv::resize(image, reduced, cv::Size(), 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
  return reduced;
}

GreyView View(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<int>(image.step)};
}

// Forward and backward search at reduced resolution, refinement at full.
class StereoMatcher {
 public:
  StereoMatcher(const StereoImages& images, const StereoRig& rig, const FeatureOptions& options)
      : images_(images),
        rig_(rig),
        options_(options),
        reduction_(SearchReduction(images.left.size(), options)),
        range_{1.0 / (options.min_depth_baselines * rig.Baseline()), options.epipolar_band_px},
        to_right_(LeftSide(), RightSide(), rig.right_from_left, reduction_),
        to_left_(RightSide(), LeftSide(), rig.right_from_left.Inverse(), reduction_) {}

  std::optional<Candidate> Find(std::size_t keypoint, const Eigen::Vector2d& left) const {
    const auto coarse = to_right_.Find(left, range_);
    if (!coarse || coarse->correlation < options_.min_correlation - kCoarseLoss ||
        coarse->correlation - coarse->runner_up < options_.min_uniqueness ||
        !LeadsBack(*coarse, left)) {
      return std::nullopt;
    }
    const auto aligned = Align(left, *coarse);
    if (!aligned || aligned->correlation < options_.min_correlation ||
        aligned->sigma_px > kMaxSigmaPx || !Usable(aligned->warp.position)) {
      return std::nullopt;
    }
    const auto error = EpipolarErrorPx(rig_, left, aligned->warp.position);
    if (!error || std::abs(*error) > options_.epipolar_band_px) return std::nullopt;
    return Candidate{
        keypoint, {aligned->warp.position, aligned->warp.linear}, aligned->correlation, *error};
  }

 private:
  static constexpr double kCoarseLoss = 0.1;   // rounding and missing warp cost so much correlation
  static constexpr double kMaxSigmaPx = 0.25;  // worse than SIFT itself: no texture along one side

  EpipolarSearch::Side LeftSide() const {
    return {Reduce(images_.left, reduction_), rig_.left.camera};
  }
  EpipolarSearch::Side RightSide() const {
    return {Reduce(images_.right, reduction_), rig_.right.camera};
  }

  bool Usable(const Eigen::Vector2d& right) const {
    const int x = cvRound(right.x()), y = cvRound(right.y());
    return x >= 0 && y >= 0 && x < images_.right_mask.cols && y < images_.right_mask.rows &&
           images_.right_mask.at<std::uint8_t>(y, x) != 0;
  }

  bool LeadsBack(const EpipolarMatch& coarse, const Eigen::Vector2d& left) const {
    // In the whole band again: a place off its line by some rows has its own line as far off.
    const auto back = to_left_.Find(coarse.pixel, range_);
    return back && (back->pixel - left).norm() <= 2.0 * reduction_;
  }

  // The warp that a plane facing the camera at the found depth would show, refined.
  std::optional<PatchAlignment> Align(const Eigen::Vector2d& left,
                                      const EpipolarMatch& coarse) const {
    const Eigen::Vector2i centre(cvRound(left.x()), cvRound(left.y()));
    auto start = WarpOf([&](const Eigen::Vector2d& offset) -> Eigen::Vector2d {
      const auto normalised = Undistort(rig_.left.camera, left + offset);
      return normalised ? to_right_.Transfer(*normalised, coarse.inverse_depth)
                        : Eigen::Vector2d::Constant(std::nan(""));
    });
    if (!start) return std::nullopt;
    const Eigen::Vector2d offset = left - centre.cast<double>();
    start->position = coarse.pixel - start->linear * offset;
    PatchAlignmentOptions alignment;
    alignment.max_shift_px = 2.0 * reduction_;
    auto aligned = AlignPatch(View(images_.left), centre, View(images_.right), *start, alignment);
    if (aligned) aligned->warp.position += aligned->warp.linear * offset;
    return aligned;
  }

  const StereoImages& images_;
  const StereoRig& rig_;
  const FeatureOptions& options_;
  int reduction_;
  EpipolarSearch::Range range_;
  EpipolarSearch to_right_, to_left_;
};

// The best candidate of each place in the right image.
std::vector<Candidate> OneToOne(std::vector<Candidate> candidates, const cv::Size& size) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(b.correlation, a.keypoint) < std::tie(a.correlation, b.keypoint);
  });
  cv::Mat taken = cv::Mat::zeros(size, CV_8UC1);
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    auto& pixel = taken.at<std::uint8_t>(cvRound(candidate.match.right.y()),
                                         cvRound(candidate.match.right.x()));
    if (pixel) continue;
    pixel = 1;
    kept.push_back(candidate);
  }
  return kept;
}

}  // namespace

Feature FeatureOf(const Eigen::Vector2d& left, const std::optional<StereoMatch>& match,
                  float size) {
  Feature feature{.left = left, .size = size};
  if (match) {
    feature.right = match->right;
    feature.right_from_left = match->right_from_left.cast<float>();
  }
  return feature;
}

std::optional<double> EpipolarErrorPx(const StereoRig& rig, const Eigen::Vector2d& left,
                                      const Eigen::Vector2d& right) {
  const auto left_normalised = Undistort(rig.left.camera, left);
  const auto right_normalised = Undistort(rig.right.camera, right);
  if (!left_normalised || !right_normalised) return std::nullopt;
  const RectifiedAxes axes = Rectify(rig.right_from_left);
  const double left_row = Turn(axes.rectified_from_left, *left_normalised).y();
  const double right_row = Turn(axes.rectified_from_right, *right_normalised).y();
  return rig.right.camera.MeanFocal() * (right_row - left_row);
}

StereoMatches FindStereoMatches(const StereoImages& images, const StereoRig& rig,
                                const std::vector<Eigen::Vector2d>& left_pixels,
                                const FeatureOptions& options) {
  const StereoMatcher finder(images, rig, options);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < left_pixels.size(); ++i) {
    if (const auto candidate = finder.Find(i, left_pixels[i])) candidates.push_back(*candidate);
  }
  candidates = OneToOne(std::move(candidates), images.right.size());
  StereoMatches stereo_matches;
  stereo_matches.found.resize(left_pixels.size());
  for (const Candidate& candidate : candidates) {
    stereo_matches.epipolar_errors_px.push_back(static_cast<float>(candidate.epipolar_error_px));
  }
  if (candidates.empty()) return stereo_matches;
  constexpr double kMinToleratedPx = 0.5;
  const double tolerated_px =
      std::max(kMinToleratedPx, options.max_epipolar_sigmas * kSigmaOfMedianDeviation *
                                    MedianAbsolute(stereo_matches.epipolar_errors_px));
  for (const Candidate& candidate : candidates) {
    if (std::abs(candidate.epipolar_error_px) <= tolerated_px) {
      stereo_matches.found[candidate.keypoint] = candidate.match;
    }
  }
  return stereo_matches;
}

}  // namespace rigmap
