// The gates of clouds chained by ICP, beside those that apply to any trajectory.
#pragma once

#include "gates/gates.h"
#include "registration/registration.h"

namespace rigmap {

// unheld, closure_sigmas, closure_pct.
Gates JudgeRegistration(const Registration& registration, const RegistrationGateOptions& options);

// What the odometry measured, each step with the noise of the registered one that it is compared
// with added to its own.
Odometry WithNoiseOf(const Registration& registration, Odometry odometry);

// Registered poses where a GateInputs expects adjusted ones, so that they are compared with what
// the visual odometry measured, step by step.
Adjustment AsAdjustment(const Registration& registration);

}  // namespace rigmap
