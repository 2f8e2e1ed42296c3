// Frames posed by their clouds.
#pragma once

#include <optional>
#include <vector>

#include "scene/odometry.h"

namespace rigmap {

// What is known of the registration of one frame.
struct RegisteredFrame {
  bool converged = false;
  bool held = false;     // by its surface, in all directions
  double overlap = 0.0;  // share of its points that have a counterpart
  double rms_m = 0.0;    // of their distances from the planes around these
  // Registered once more, against the cloud of the frame before the last: how far that ends from
  // the chained pose, in metres, and with its rotation in sigmas (root mean square over six axes).
  // Nothing where that failed.
  std::optional<double> closure_m, closure_sigmas;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(converged, held, overlap, rms_m, closure_m, closure_sigmas);
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

}  // namespace rigmap
