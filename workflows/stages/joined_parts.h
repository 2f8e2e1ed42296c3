// Several parts as one: the stages of `rigmap join` that take what the parts have done already.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dead_reckoning/dead_reckoning_options.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/features.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/steps.h"

namespace rigmap {

// What the parts know of each frame of the data set that joins them.
struct JoinedParts {
  struct Part {
    std::string name;    // of its folder
    int frames = 0;      // of its own
    int shared = 0;      // of these with parts before it
    std::string status;  // of its summary.json; empty: none
    // Its own trajectory, in its own world, by frames of the whole; empty where it has none.
    std::vector<std::pair<int, Rigid3>> world_from_left;
  };
  std::vector<Part> parts;           // in order of their first frame
  std::vector<std::string> missing;  // a sentence for each part that is not among them
  std::vector<int> first_part;       // of each frame, the first part that has it
  // Of each frame, by that part.
  std::vector<FrameFile> features;         // relative to the output folder of the whole
  std::vector<char> keyframes;             // not 0 where any part chose it
  std::vector<float> epipolar_px, near_m;  // those of FeatureIndex, of all parts
  std::vector<int> unreadable_frames;
  std::vector<std::string> unreadable_images;
};

// Features as the parts found them; what belongs to the rover is looked for in the whole.
using JoinedFeaturesStage = Stage<FeatureIndex, Takes<Dataset, JoinedParts>, Reads<>>;
JoinedFeaturesStage JoinedFeatures();

// One chain over all parts and their seams: the motion from frame to frame is measured anew, which
// costs hardly anything, so that a step across a seam is like any other. Where it loses its way
// corners, lone images or the rover's wheels and gyro bridge the gap, if they can. Keyframes stay
// those of the parts, whose depth is known.
using JoinedOdometryStage = Stage<Odometry, Takes<Dataset, FeatureStore, JoinedParts>,
                                  Reads<FeatureOptions, CornerOptions, MaskOptions, OdometryOptions,
                                        DeadReckoningOptions, FilterOptions>>;
JoinedOdometryStage JoinedOdometry();

// As TrajectorySteps, of the whole: after odometry, of the parts' own trajectories chained by the
// frames that they share, or else by the odometry, and after the adjustment of all; then each part
// by itself (part-NAME-alone) and its frames in the whole (part-NAME-joined).
using JoinedStepsStage = Stage<Steps, Takes<Odometry, AdjustedPart, JoinedParts>, Reads<>>;
JoinedStepsStage JoinedSteps();

// Whether all parts are there, and tied to each other by what was measured. Reports `worlds` as
// well: the names of the parts that are, the world with most frames first.
using JoinGatesCheck = Check<Takes<JoinedParts, AdjustedPart>, Reads<>>;
JoinGatesCheck JoinGates();

Report ReportParts(const JoinedParts& parts);

}  // namespace rigmap
