#include "gates/gate_options.h"

namespace rigmap {

OptionFields MappingGateOptions::Fields() {
  return {
      {"baseline_spread", &baseline_spread, "", MoreThan(0.0),
       "Relative spread (1.4826 MAD / median) of the reconstructed left-right distances before "
       "any is rejected. Healthy seeded models have 0.001 to 0.0094, failed ones 0.03 and more: "
       "the limit lies between."},
      {"baseline_rejected", &baseline_rejected, "", MoreThan(0.0),
       "Share of those distances that were rejected. They are normally distributed in a healthy "
       "model, where five sigmas reject none; a fifth means that the model has bent or broken "
       "somewhere."},
      {"registered", &registered, "", MoreThan(0.0),
       "Least share of keyframes in the model used. The rest hangs on odometry, and a tenth of "
       "it is what a few bad images may cost."},
  };
}

OptionFields PoseGateOptions::Fields() {
  return {
      {"predicted", &predicted, "", MoreThan(0.0),
       "Share of frames posed by prediction alone. A black image or two may be bridged; where "
       "more than a fifth of the trajectory is guessed it is not a measurement any more."},
      {"breaks", &breaks, "", AtLeast(0.0),
       "How often the way may begin anew, nothing measured joining what follows to what was "
       "before. "
       "The sigma of the guess between is that of a motion that goes on as it did: a film that was "
       "cut there goes on anywhere."},
      {"accuracy_pct", &accuracy_pct, "per cent", MoreThan(0.0),
       "How good a result has to be, as --accuracy sets it: of the scale, and of the worst "
       "measured "
       "position as a share of the path (or of a metre if that is longer), both at 95 % by the "
       "result's own sigmas. One per cent is what people ask of odometry; a rover's part that is "
       "tracked throughout has 0.1 to 0.4. It is the limit of depth_consistency_pct as well: "
       "depths that contradict each other by more cannot give metres as good; and the least limit "
       "of motion_agreement_drift."},
  };
}

OptionFields AdjustmentGateOptions::Fields() {
  return {
      {"motion_agreement_sigmas", &motion_agreement_sigmas, "sigmas", MoreThan(0.0),
       "Adjusted against odometric steps, in sigmas of the odometry. A step fails that is beyond "
       "this and beyond motion_agreement_pct, the gate if a tenth of the steps does. Not three "
       "sigmas, because the odometry takes matches for independent, and neighbours in an image "
       "err together; healthy parts have 1 to 3."},
      {"motion_agreement_pct", &motion_agreement_pct, "per cent", MoreThan(0.0),
       "The same as a share of the step. Five per cent is far beyond the 0.1 to 0.4 % that good "
       "steps differ by."},
      {"reprojection_px", &reprojection_px, "px", MoreThan(0.0),
       "Median reprojection error. Sharp images have 0.1, poor ones 0.5; beyond a pixel, points "
       "and poses contradict each other."},
      {"outlier_share", &outlier_share, "", MoreThan(0.0),
       "Share of observations that the adjustment dropped. Verified matches of a healthy part "
       "lose up to an eighth; at three tenths good and bad can no longer be told apart safely."},
  };
}

OptionFields CalibrationGateOptions::Fields() {
  return {
      {"epipolar_px", &epipolar_px, "px", MoreThan(0.0),
       "Median distance of stereo matches from their epipolar line. Good real rigs have up to "
       "0.6. A row that is off by a pixel is a pitch of 0.07 degrees at 840 px."},
      {"rig_refinement_share", &rig_refinement_share, "", MoreThan(0.0),
       "Largest shift, as a share of the image's width, by which the correction of the rig moves "
       "the right image of what is infinitely far; more where the prior of the adjustment expects "
       "more, by three sigmas. Real rig files that were corrected well were off by 0.2 to 0.7 % (3 "
       "px of 512 in the worst); beyond it is another rig's file, or the images are wrong."},
      {"max_depth_error_share", &max_depth_error_share, "", MoreThan(0.0),
       "Largest share by which the disparity at infinity may falsify the depth of the median "
       "point, at z: the limit of infinity_offset_px is this share of its disparity f b / z, that "
       "of "
       "rig_consistency_deg the turn b / z that shifts disparities as much, 0.005 degrees at 2.7 m "
       "for a baseline of 0.12 m. A correction that the images know no better than this limit says "
       "nothing, and passes."},
      {"intrinsics_consistency_pct", &intrinsics_consistency_pct, "per cent", MoreThan(0.0),
       "Correction of the focal lengths that the images ask for. Depths err by the same share."},
      {"consistency_sigmas", &consistency_sigmas, "sigmas", MoreThan(0.0),
       "By how many of its own sigmas a correction of the rotation, of the disparity at infinity "
       "or "
       "of the focal lengths may be beyond its limit: so much may be chance. Their sigmas count "
       "what tracks and frames share."},
  };
}

OptionFields DepthGateOptions::Fields() {
  return {
      {"depth_bias_px", &depth_bias_px, "px", MoreThan(0.0),
       "Median disparity of dense matching less that of sparse points, whichever its sign. At 3 "
       "m, 0.1 px is 0.3 % of the depth (f b = 100 px m)."},
  };
}

OptionFields RegistrationGateOptions::Fields() {
  return {
      {"unheld", &unheld, "", MoreThan(0.0),
       "Share of frames whose cloud its surface does not hold in all directions, so that it could "
       "slide. As predicted: beyond a fifth the trajectory is no measurement any more."},
      {"closure_sigmas", &closure_sigmas, "sigmas", MoreThan(0.0),
       "By how much a cloud registered against that of the frame before the last ends off the "
       "chained pose, in sigmas of both. The gate fails if a tenth of the frames is beyond this "
       "and "
       "a tenth beyond closure_pct. Not three sigmas: where clouds overlap less, other points "
       "count; healthy parts have 1 to 2."},
      {"closure_pct", &closure_pct, "per cent", MoreThan(0.0),
       "The same of the way between, at least a box of the grid. As motion_agreement_pct."},
  };
}

OptionFields GateOptions::Fields() {
  return JoinFields({mapping.Fields(), poses.Fields(), adjustment.Fields(), calibration.Fields(),
                     dense.Fields(), registration.Fields()});
}

}  // namespace rigmap
