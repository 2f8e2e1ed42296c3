// Ground that lay in the light before a shadow came over it.
#pragma once

#include <deque>
#include <opencv2/core.hpp>

#include "fusion/internal/view_consistency.h"

namespace rigmap {

// The rover's own shadow goes along with it: the frames that see a spot best see it in the shade,
// and so would the map; the shadow of who walks by lies there for a moment. Frames from further
// back saw the spot lit. Works on blocks of a 256th of the image's width. Not thread-safe; uses all
// threads, and the result does not depend on their number.
class PastLight {
 public:
  // The colours of the next frame's view, where it is in such a shade by what the frames before
  // saw. `brightness`: the factor that makes the frame as bright as these. What was as dark before
  // stays so, as does what fewer than four of them saw. Those after it ask this frame, too, unless
  // it was taken from nearly the same place as the one before.
  cv::Mat Lit(const DepthView& view, double brightness);

 private:
  void Remember(DepthView blocks);

  std::deque<DepthView> past_;  // latest first; of blocks, the colours CV_32FC3, no sigmas
};

}  // namespace rigmap
