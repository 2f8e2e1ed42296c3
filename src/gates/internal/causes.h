// The causes that a refusal tells, each from the gates that failed and what else is known.
#pragma once

#include "gates/internal/failed.h"

namespace rigmap {

// Without the gates. Each expects that one of the gates named beside it has failed.
Cause RigDoesNotFit(const Failed& failed);      // epipolar_px
Cause NothingToFollow(const Failed& failed);    // predicted
Cause WayIsBroken(const Failed& failed);        // breaks
Cause RigIsContradicted(const Failed& failed);  // rig_refinement, rig_ and intrinsics_consistency
Cause FewRegistered(const Failed& failed);      // registered
Cause MapIsBent(const Failed& failed);          // baseline_spread, baseline_rejected
Cause MatchesContradict(const Failed& failed);  // reprojection_px, outlier_share
Cause MotionsDiffer(const Failed& failed);      // motion_agreement_window, _sigmas, _pct
Cause MotionsDrift(const Failed& failed);       // motion_agreement_drift
Cause SensorsContradict(const Failed& failed);  // sensors_contradict
Cause CloudsSlide(const Failed& failed);        // unheld
Cause ChainsDiffer(const Failed& failed);       // closure_sigmas, closure_pct
Cause LengthsDiffer(const Failed& failed);      // length_pct
Cause DepthsDisagree(const Failed& failed);     // depth_consistency_pct
Cause NotAsGoodAsAsked(const Failed& failed);   // scale_95_pct, position_95_pct
Cause DenseDiffers(const Failed& failed);       // depth_bias_px
Cause PartsLieApart(const Failed& failed);      // worlds
Cause PartsAreMissing(const Failed& failed);    // parts_missing

}  // namespace rigmap
