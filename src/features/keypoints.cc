#include "features/keypoints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

// OpenCV's SIFT doubles the image first and in 4.6 forgets half a pixel of the doubled image when
// it scales back: positions come out this much too large (tests/features draws blobs to show it).
constexpr double kSiftOffsetPx = 0.25;

struct Ranked {
  int index;
  int rank;  // place among the keypoints of its cell, strongest first
};

// Indices of at most `count` keypoints: the strongest of every grid cell, then every cell's second,
// and so on, so that a bright rock does not take the sand's share.
std::vector<int> SpreadEvenly(const std::vector<cv::KeyPoint>& keypoints, const cv::Size& size,
                              int count) {
  constexpr double kKeypointsPerCell = 4.0;
  const double cell = std::sqrt(size.area() * kKeypointsPerCell / count);
  std::vector<int> order(keypoints.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const auto &p = keypoints[a], &q = keypoints[b];
    return std::tie(q.response, p.pt.y, p.pt.x, a) < std::tie(p.response, q.pt.y, q.pt.x, b);
  });
  std::map<std::pair<int, int>, int> in_cell;
  std::vector<Ranked> ranked;
  for (int index : order) {
    const auto& at = keypoints[index].pt;
    ranked.push_back(
        {index, in_cell[{static_cast<int>(at.y / cell), static_cast<int>(at.x / cell)}]++});
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Ranked& a, const Ranked& b) { return a.rank < b.rank; });
  std::vector<int> chosen;
  for (const Ranked& r : ranked) {
    if (static_cast<int>(chosen.size()) == count) break;
    chosen.push_back(r.index);
  }
  return chosen;
}

// SIFT gives a place several times, once per dominant direction; the strongest stays.
void RemoveSamePosition(std::vector<cv::KeyPoint>& keypoints) {
  const auto key = [](const cv::KeyPoint& k) { return std::tie(k.pt.y, k.pt.x); };
  std::sort(keypoints.begin(), keypoints.end(), [&](const auto& a, const auto& b) {
    return std::tuple_cat(key(a), std::tie(b.response, a.angle)) <
           std::tuple_cat(key(b), std::tie(a.response, b.angle));
  });
  keypoints.erase(std::unique(keypoints.begin(), keypoints.end(),
                              [&](const auto& a, const auto& b) { return key(a) == key(b); }),
                  keypoints.end());
}

// Place in the full image of a position that SIFT found in the image reduced by `reduction`.
// INTER_AREA halving puts the centre of half pixel h at 2 h + 0.5.
Eigen::Vector2d FullPixel(const cv::Point2f& at, int reduction) {
  const auto full = [&](double x) {
    return reduction * (x - kSiftOffsetPx) + 0.5 * (reduction - 1);
  };
  return {full(at.x), full(at.y)};
}

// On the full mask rather than through SIFT, which would take a halved one half a pixel off.
void RemoveMasked(std::vector<cv::KeyPoint>& keypoints, const cv::Mat& mask, int reduction) {
  std::erase_if(keypoints, [&](const cv::KeyPoint& keypoint) {
    const Eigen::Vector2d pixel = FullPixel(keypoint.pt, reduction);
    const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
    return !cv::Rect(cv::Point(), mask.size()).contains(at) || mask.at<std::uint8_t>(at) == 0;
  });
}

constexpr int kOctaveLayers = 3;

cv::Ptr<cv::SIFT> MakeSift(double contrast_threshold) {
  // Ratio of curvatures beyond which a keypoint slides along an edge (Lowe 2004, sec. 4.1).
  constexpr double kEdgeThreshold = 10.0;
  constexpr double kSigma = 1.6;
  // OpenCV divides the threshold by the number of layers.
  return cv::SIFT::create(0, kOctaveLayers, contrast_threshold * kOctaveLayers, kEdgeThreshold,
                          kSigma);
}

// The faint ones are dropped again where there are enough without them: SIFT's scale space is most
// of the work, and made once. A keypoint's response is what SIFT compares with its threshold.
std::vector<cv::KeyPoint> Detect(const cv::Mat& image, const cv::Mat& mask, int reduction,
                                 const FeatureOptions& options, cv::SIFT& sift) {
  std::vector<cv::KeyPoint> found;
  sift.detect(image, found);
  RemoveMasked(found, mask, reduction);
  RemoveSamePosition(found);
  const auto is_faint = [&](const cv::KeyPoint& keypoint) {
    return keypoint.response < options.contrast_threshold;
  };
  const auto strong = static_cast<std::ptrdiff_t>(found.size()) -
                      std::count_if(found.begin(), found.end(), is_faint);
  if (strong >= options.max_keypoints) std::erase_if(found, is_faint);
  return found;
}

}  // namespace

int SearchReduction(const cv::Size& size, const FeatureOptions& options) {
  return size.area() > 1e6 * options.half_resolution_above_mpx ? 2 : 1;
}

Keypoints DetectKeypoints(const cv::Mat& grey, const cv::Mat& mask, const FeatureOptions& options) {
  const int reduction = SearchReduction(grey.size(), options);
  cv::Mat image = grey;
  if (reduction == 2) cv::resize(grey, image, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  const auto sift =
      MakeSift(std::min(options.contrast_threshold, options.faint_contrast_threshold));
  const std::vector<cv::KeyPoint> found = Detect(image, mask, reduction, options, *sift);
  Keypoints result{.searched = std::move(image)};
  for (int index : SpreadEvenly(found, result.searched.size(), options.max_keypoints)) {
    const cv::KeyPoint& keypoint = result.found.emplace_back(found[index]);
    result.pixels.push_back(FullPixel(keypoint.pt, reduction));
    result.sizes.push_back(static_cast<float>(reduction) * keypoint.size);
  }
  return result;
}

std::vector<Descriptor> Describe(const Keypoints& keypoints,
                                 const std::vector<std::size_t>& chosen) {
  if (chosen.empty()) return {};
  std::vector<cv::KeyPoint> described;
  for (const std::size_t i : chosen) described.push_back(keypoints.found[i]);
  cv::Mat values;
  constexpr double kAnyContrast = 0.0;  // they have been found already
  MakeSift(kAnyContrast)->compute(keypoints.searched, described, values);
  std::vector<Descriptor> descriptors(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const float* row = values.ptr<float>(static_cast<int>(i));
    std::transform(row, row + kDescriptorSize, descriptors[i].begin(),
                   [](float value) { return static_cast<std::uint8_t>(value); });
  }
  return descriptors;
}

}  // namespace rigmap
