#include "features/internal/grey_pair.h"

#include <opencv2/imgproc.hpp>

#include "imaging/image.h"

namespace rigmap {

std::optional<GreyPair> ReadGreyPair(const StereoFrame& frame, const StereoRig& rig,
                                     std::vector<std::string>& unreadable) {
  const auto read = [&](Eye eye) -> cv::Mat {
    try {
      return ReadGrey(frame.PathOf(eye), rig.Of(eye).camera, frame.sample_bits);
    } catch (const UnreadableImage&) {
      unreadable.push_back(frame.PathOf(eye));
      return {};
    }
  };
  GreyPair pair{read(Eye::kLeft), read(Eye::kRight)};
  if (pair.left.empty() || pair.right.empty()) return std::nullopt;
  return pair;
}

cv::Mat Smooth(const cv::Mat& grey) {
  constexpr double kSigmaPx = 0.8;
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, cv::Size(5, 5), kSigmaPx);
  return smooth;
}

}  // namespace rigmap
