// A stereo rover that drives over random points: exact poses and points, and what a feature
// detector and matcher would have made of them. Equal options give equal rovers.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "scene/features.h"
#include "scene/rig.h"
#include "scene/sampled_features.h"

namespace rigmap {

struct SyntheticRoverOptions {
  int frames = 12;
  double step_m = 0.2;            // travelled between frames
  double curve_rad_per_m = 0.05;  // to the left
  double points_per_m2 = 25.0;    // of ground; about 500 features a frame
  double relief_m = 0.15;         // points lie within this above and below the ground
  double max_range_m = 8.0;       // points further away are not seen
  double pixel_sigma = 0.2;       // px, each coordinate, each eye
  StampNs first_stamp_ns = 1448551416619000000;
  StampNs frame_interval_ns = 400'000'000;
  unsigned seed = 1;
  // Patches show a random texture of their point, fixed to the ground: the same in every frame but
  // for the distance, and centred on the true pixel, not on the noisy one.
  bool textured_patches = false;
};

// The rig of Katwijk's LocCam: 1024 x 768, 834 px, distorted, 12 cm baseline.
StereoRig LocCamRig();

// World: metres, z up, x the first heading, origin at the first left camera, which looks 18 degrees
// down from 1.1 m above the ground.
struct SyntheticRover {
  StereoRig rig;
  std::vector<Rigid3> world_from_left;  // one per frame
  std::vector<Eigen::Vector3d> points;  // in world
  // One per frame, features in random order. Descriptors belong to the point, exact in every frame
  // and unlike each other; patches are zero unless asked for. A feature without stereo match lies
  // outside the right image.
  std::vector<FrameFeatures> frames;
  std::vector<std::vector<int>> point_of_feature;  // [frame][feature] -> index into points
  unsigned seed = 0;                               // of the textures
};

SyntheticRover MakeSyntheticRover(const SyntheticRoverOptions& options = {});

// As above on any path: a pose per frame, in place of frames, step and curve of the options.
SyntheticRover MakeSyntheticRover(const SyntheticRoverOptions& options,
                                  const std::vector<Rigid3>& world_from_left);

// What a frame shows at these pixels: the texture of the point next to each, as its patches do if
// they are asked for, and its stereo match, without noise. Nothing where no point is within 12 px.
std::vector<std::optional<SampledFeature>> SampleFeatures(
    const SyntheticRover& rover, int frame, const std::vector<Eigen::Vector2d>& pixels);

// world_from_left of a rover at (x, y) metres that heads heading_rad to the left of x.
Rigid3 RoverPose(double x_m, double y_m, double heading_rad);

// (feature of frame a, feature of frame b) of every point seen in both, by rising point index.
std::vector<std::pair<int, int>> TrueMatches(const SyntheticRover& rover, int frame_a, int frame_b);

}  // namespace rigmap
