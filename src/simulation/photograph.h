// The images of a drive: rendered, taken, spoilt where a fault says so, and written.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "scene/rig.h"
#include "simulation/drive.h"
#include "simulation/moving_bodies.h"
#include "simulation/view_renderer.h"

namespace rigmap {

class Photographer {
 public:
  // All must outlive this.
  Photographer(const World& world, const StereoRig& rig, const DrivePlan& plan,
               const RoverMotion& motion);

  // The picture of one eye, without what happens to its file. Thread-safe.
  cv::Mat Take(const DriveFrame& frame, Eye eye) const;

  // Writes the image's file into `folder` under Katwijk's name, if the frame has it. Returns the
  // share of saturated pixels.
  double Write(const DriveFrame& frame, Eye eye, const std::filesystem::path& folder) const;

 private:
  std::vector<PosedBody> BodiesAt(const DriveFrame& frame) const;

  const StereoRig& rig_;
  const World& world_;
  const DrivePlan& plan_;
  const RoverMotion& motion_;
  std::array<ViewRenderer, 2> renderers_;
  std::unique_ptr<Body> rover_;
  std::vector<std::unique_ptr<Body>> strides_;  // a person's
};

// "LocCam_<stamp>_0.png" for the left eye, _1 for the right.
std::string ImageFileName(StampNs stamp_ns, Eye eye);

}  // namespace rigmap
