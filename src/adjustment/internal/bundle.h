// One least-squares problem over poses and points. Of this room only.
#pragma once

#include <optional>
#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

struct Bundle {
  StereoRig rig;
  std::vector<std::optional<Rigid3>> left_from_world;
  std::vector<AdjustedPoint> points;  // observed by frames that have a pose
};

// Relative change of the cost at which the solver stops. With 1e-5 a damped solver stopped too
// early on long parts (13.9 instead of 6.9 mm over 400 pairs); undamped, as it is now, the poses of
// 103 pairs are the same from here to 1e-8.
inline constexpr double kFineTolerance = 1e-7;
// Before outliers are dropped and the rig has settled there is no point in the last digits: with
// 1e-4 the ATE and scale of real drives are the same to half a per cent of themselves.
inline constexpr double kRoughTolerance = 1e-3;

// Moves poses and points to the least sum of Huber's loss over all observations. Datum frames
// (DatumFrames) and the rig are held. Residuals beyond `huber_px` are weighted down.
void SolveBundle(double huber_px, double function_tolerance, Bundle& bundle);

// Distance (px) of each observation from its point's image, point by point; infinite behind an eye.
std::vector<double> ErrorsPx(const Bundle& bundle);

// Drops observations beyond the limit, given ErrorsPx, then points that fewer than two frames still
// show.
void DropBeyond(double limit_px, const std::vector<double>& errors_px, Bundle& bundle);
// Drops points that their observations do not determine.
void DropUndetermined(Bundle& bundle);
// A frame with hardly an observation would float: takes its pose away, and its observations with
// it, which may leave others with too few.
void DropThinFrames(Bundle& bundle);

std::vector<int> ObservationsPerFrame(const Bundle& bundle);
std::size_t ObservationCount(const std::vector<AdjustedPoint>& points);

// Robust sigma (px) of one coordinate, by ErrorsPx.
double NoisePx(const std::vector<double>& errors_px, const Bundle& bundle);
// Largest distance (m) of a left camera from the first.
double PathExtent_m(const Bundle& bundle);

}  // namespace rigmap
