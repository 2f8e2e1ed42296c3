// The checks of a part: whether its poses and its depths are to be trusted.
#pragma once

#include <string>

#include "gates/findings.h"
#include "pipeline/stage.h"
#include "registration/registration.h"
#include "workflows/stages/adjustment.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/features.h"
#include "workflows/stages/mapping.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {

using AdjustedGatesCheck = Check<
    Takes<Dataset, FeatureIndex, AlignedKeyframes, AdjustedPart>,
    Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions, CalibrationGateOptions>>;
AdjustedGatesCheck AdjustedGates();

// The same of poses that COLMAP's mapping alone has made: the focal length was held and nothing
// checked it, so that its prior counts.
using MappedGatesCheck = Check<Takes<Dataset, FeatureIndex, AlignedKeyframes, AdjustedPart>,
                               Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions,
                                     CalibrationGateOptions, AdjustmentOptions>>;
MappedGatesCheck MappedGates();

// Without an odometry to agree with, nor keypoints of rigmap's; what COLMAP changed of the focal
// lengths counts as unknown of all lengths, beside their prior.
using FreeCameraGatesCheck = Check<Takes<Dataset, MappingResult, AlignedKeyframes, AdjustedPart>,
                                   Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions,
                                         CalibrationGateOptions, AdjustmentOptions>>;
FreeCameraGatesCheck FreeCameraGates();

// What of these applies to poses that nothing adjusted.
using OdometricGatesCheck = Check<
    Takes<Dataset, FeatureIndex, Odometry, OdometricPart>,
    Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions, CalibrationGateOptions>>;
OdometricGatesCheck OdometricGates();

// The same where wheels alone tell the metres.
OdometricGatesCheck DeadReckonedGates();

// Of clouds chained by ICP, with what the visual odometry measured of the same motion beside it.
using RegistrationGatesCheck =
    Check<Takes<Dataset, FeatureIndex, Odometry, Registration, OdometricPart>,
          Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions, CalibrationGateOptions,
                RegistrationGateOptions>>;
RegistrationGatesCheck RegistrationGates();

using DepthGatesCheck = Check<Takes<DepthIndex>, Reads<DepthGateOptions>>;
DepthGatesCheck DepthGates();

// What everything made of a part has to bear; empty where it is to be trusted.
struct Warning {
  std::string text;
};
// A view.
Warning WarningByGates(const StageContext& context, const Report& gates, const Report& depth_gates);
// A view: the first report with the gates of the second behind its own.
Report WithMoreGates(const StageContext& context, const Report& gates, const Report& more);

}  // namespace rigmap
