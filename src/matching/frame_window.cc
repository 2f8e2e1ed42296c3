#include "matching/frame_window.h"

#include <algorithm>

namespace rigmap {

FrameWindow::FrameWindow(FeatureSource features, const StereoRig& rig, double disparity_noise_px,
                         std::size_t held_frames)
    : features_(std::move(features)),
      rig_(rig),
      disparity_noise_px_(disparity_noise_px),
      held_frames_(std::max<std::size_t>(2, held_frames)) {}

MatchedFrame& FrameWindow::At(int frame) {
  std::erase(by_use_, frame);
  by_use_.push_back(frame);
  const auto held = held_.find(frame);
  if (held != held_.end()) return held->second;
  if (by_use_.size() > held_frames_) {
    LetGo(by_use_.front());
    by_use_.pop_front();
  }
  return held_.emplace(frame, Load(frame)).first->second;
}

std::vector<std::vector<Feature>> FrameWindow::Finish(int frame_count) {
  for (const int frame : by_use_) LetGo(frame);
  by_use_.clear();
  std::vector<std::vector<Feature>> refined;
  for (int frame = 0; frame < frame_count; ++frame) {
    const auto kept = kept_.find(frame);
    refined.push_back(kept != kept_.end() ? std::move(kept->second.refined)
                                          : features_(frame).features);
  }
  kept_.clear();
  return refined;
}

MatchedFrame FrameWindow::Load(int frame) const {
  MatchedFrame loaded;
  loaded.refinement = StartRefinement(features_(frame));
  const auto kept = kept_.find(frame);
  if (kept != kept_.end())
    RestorePositions(kept->second.refined, kept->second.aligned, loaded.refinement);
  loaded.points = TriangulateFeatures(loaded.refinement.found.features, rig_, disparity_noise_px_);
  return loaded;
}

void FrameWindow::LetGo(int frame) {
  const auto held = held_.find(frame);
  FeatureRefinement& refinement = held->second.refinement;
  kept_[frame] = {std::move(refinement.refined), std::move(refinement.aligned)};
  held_.erase(held);
}

}  // namespace rigmap
