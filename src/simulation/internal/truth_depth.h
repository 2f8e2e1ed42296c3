// True depth of the left camera's view.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "geometry/camera.h"
#include "scene/rig.h"
#include "simulation/world.h"

namespace rigmap {

constexpr double kTruthDepthUnit_m = 0.0005;

// A pinhole view along the left camera's axes that covers both eyes' undistorted images, as wide to
// every side as the widest of them and four pixels more. The focal length is the left eye's rounded
// up to a whole hundred, the principal point lies in the middle. LocCam: 900 px, 1458 x 1066.
Camera TruthDepthCamera(const StereoRig& rig);

// z along the optical axis, CV_16UC1, in units of kTruthDepthUnit_m; 0 for the sky and what is
// farther than 32.7 m. Rays are cast by TBB's threads.
cv::Mat RenderTruthDepth(const World& world, const Camera& view, const Rigid3& world_from_left);

// `folder`/depth_NNNN.png. Throws DataError when it cannot be written.
void WriteTruthDepth(const std::filesystem::path& folder, int frame, const cv::Mat& depth);

// `folder`/camera.json: fx, fy, cx, cy (pixels, the centre of the first is (0, 0)), unit_m,
// invalid, value.
void WriteTruthDepthCamera(const std::filesystem::path& folder, const Camera& view);

}  // namespace rigmap
