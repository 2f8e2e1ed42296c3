// Where on a drive faults happen.
#pragma once

#include <string>
#include <vector>

#include "simulation/faults.h"
#include "simulation/internal/fault_request.h"

namespace rigmap {

// Chooses frames for what is asked for, by the request's own random numbers, and keeps account of
// the frames whose images are gone. Only ranges may touch the first and the last two frames. All
// throw UsageError for a value that is not understood or more than there is room for.
class FaultFrames {
 public:
  explicit FaultFrames(int frames);

  // Frames of which the request takes the images: a range as it is given, or so many frames that
  // have theirs, anywhere or in a row. Throw UsageError where another fault has them.
  std::vector<int> TakeSingles(FaultRequest& request);
  std::vector<int> TakeRun(FaultRequest& request);

  // So many frames, rising.
  std::vector<int> Choose(FaultRequest& request) const;

  // A range as it is given, or so many stretches of `mean_frames`, one in each of as many equal
  // slices of the drive; shorter only where the drive is.
  std::vector<FrameRange> Spread(FaultRequest& request, double mean_frames) const;

 private:
  std::vector<int> Open() const;
  std::vector<int> Untaken() const;
  std::vector<int> TakeRange(const FaultRequest& request);
  std::vector<int> Take(const FaultRequest& request, const std::vector<int>& frames);

  int frames_, open_frames_;
  std::vector<std::string> lost_to_;  // per frame: the fault that takes its images, or empty
};

}  // namespace rigmap
