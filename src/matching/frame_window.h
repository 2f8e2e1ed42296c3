// The frames that are being matched, loaded when needed and let go again.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "correspondence/stereo_points.h"
#include "matching/reference_patches.h"

namespace rigmap {

struct MatchedFrame {
  FeatureRefinement refinement;
  std::vector<std::optional<StereoPoint>> points;  // of the features as found
};

// Holds descriptors, patches and reference patches (2 MB a frame) of the frames used last; of all
// others the refined positions only. A frame that comes back has its own patches for reference
// patches.
class FrameWindow {
 public:
  // At least two frames are held.
  FrameWindow(FeatureSource features, const StereoRig& rig, double disparity_noise_px,
              std::size_t held_frames);

  // Stays valid until `held_frames` other frames have been asked for.
  MatchedFrame& At(int frame);

  // The refined features of frames 0 to frame_count - 1, whether they were asked for or not.
  std::vector<std::vector<Feature>> Finish(int frame_count);

 private:
  struct Kept {
    std::vector<Feature> refined;
    std::vector<char> aligned;
  };
  MatchedFrame Load(int frame) const;
  void LetGo(int frame);

  FeatureSource features_;
  const StereoRig& rig_;
  double disparity_noise_px_;
  std::size_t held_frames_;
  std::map<int, MatchedFrame> held_;
  std::deque<int> by_use_;  // frames held, used longest ago first
  std::map<int, Kept> kept_;
};

}  // namespace rigmap
