// Clouds of frames chained to a trajectory.
#pragma once

#include <functional>
#include <vector>

#include "registration/frame_cloud.h"
#include "registration/registration_options.h"
#include "scene/odometry.h"
#include "trajectory/motion_model.h"

namespace rigmap {

// What is known of the registration of one frame.
struct RegisteredFrame {
  bool converged = false;
  double overlap = 0.0;  // share of its points that have a counterpart
  double rms_m = 0.0;    // of their distances from the planes around these
  // Registered once more, against the cloud of the frame before the last: how far that ends from
  // the chained pose, m and rad. Nothing where that failed.
  std::optional<double> closure_m, closure_rad;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(converged, overlap, rms_m, closure_m, closure_rad);
  }
};

struct Registration {
  Odometry motion;  // every frame; source kOdometry where it was registered
  std::vector<RegisteredFrame> frames;
  double grid_m = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(motion, frames, grid_m);
  }
};

// The cloud of a frame; empty where it shows nothing.
using CloudSource = std::function<FrameCloud(int frame)>;

// Each cloud is registered against those of the last keyframes, and its pose hangs on the last of
// them. `odometry`: what was measured otherwise, for first guesses and the stamps; an entry per
// frame. Frames that cannot be registered are predicted. Holds the clouds of the keyframes and of
// two frames more. Runs in one thread: the order of frames is what makes a chain.
Registration RegisterFrames(const CloudSource& clouds, const Odometry& odometry, double grid_m,
                            const RegistrationOptions& options, const UnmeasuredMotion& unmeasured);

}  // namespace rigmap
