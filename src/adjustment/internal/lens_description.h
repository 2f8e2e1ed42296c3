// What of a lens its model does not describe, as far as a part tells it. Of this room only.
#pragma once

#include "adjustment/adjustment_options.h"
#include "adjustment/internal/calibration_border.h"
#include "adjustment/internal/lens_field.h"

namespace rigmap {

// A field under a prior that keeps its parameters near zero, whose sigma the part tells as well.
class LensDescription {
 public:
  explicit LensDescription(const StereoRig& rig) : field_(rig) {}

  // Nothing while there is none.
  const LensField* Field() const { return information_ > 0.0 ? &field_ : nullptr; }
  // Of the prior, of each parameter (1/px^2), in the units of observations that are independent.
  double Information() const { return information_; }

  // True, with a field that is still zero, where stretches of the part fit better by what the
  // others leave in their residuals: by as much and as unanimously as for a correction of the rig.
  bool Begin(const Linearisation& at, const AdjustmentOptions& options);
  // The prior's sigma that makes what the part says of the field most probable (MacKay 1992), at
  // most that of the options.
  void TakeSigma(const Linearisation& at, const CalibrationSolution& solution,
                 const CalibrationPrior& prior, const CalibrationVector& correction,
                 const AdjustmentOptions& options);
  void Move(const Eigen::VectorXd& step) { field_.Move(step); }

 private:
  void SetSigma(double sigma_px) {
    sigma_px_ = sigma_px;
    information_ = inflation_ / (sigma_px * sigma_px);
  }

  LensField field_;
  double sigma_px_ = 0.0, information_ = 0.0;
  double inflation_ = 1.0;  // of the observations' variance
};

}  // namespace rigmap
