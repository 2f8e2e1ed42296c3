// The fit of a path to fixes in a plane, motion and clock together.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "georeference/internal/antenna_path.h"
#include "georeference/rigid2.h"

namespace rigmap {

// A measured place of the antenna, metres of the plane.
struct PlaneFix {
  double time_s = 0.0;              // by the receiver's clock, since the path's first pose
  Eigen::Vector2d position, sigma;  // each axis; sigma positive
};

struct PathFit {
  Rigid2 plane_from_world;
  double clock_offset_s = 0.0;  // receiver's clock minus that of the path
  Eigen::Vector2d world_centre = Eigen::Vector2d::Zero();  // mean of the used antenna positions
  // Of the place of world_centre in the plane (m), the angle (rad) and the clock (s; zero where it
  // was held). Only where `determined`.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  bool determined = false;
  std::vector<PlanePair> used;  // path to fixes, within four sigmas
  std::size_t outliers = 0;
};

class PathFitter {
 public:
  // `path` is not empty and outlives the fitter.
  PathFitter(const AntennaPath& path, std::vector<PlaneFix> fixes)
      : path_(path), fixes_(std::move(fixes)) {}

  // Within max_offset_s either way, to 0.05 s, by robust fits; 0 where no offset leaves min_fixes
  // (at least 3) on the path.
  double BestOffset(double max_offset_s, std::size_t min_fixes) const;

  // From a robust fit at this offset by Gauss-Newton to the least squares of the fixes within four
  // sigmas; the offset is fitted too or held.
  PathFit Refine(double clock_offset_s, bool with_clock) const;

 private:
  std::vector<PlanePair> PairsAt(double clock_offset_s) const;
  double Step(PathFit& fit, bool with_clock) const;
  void SelectPairs(PathFit& fit) const;

  const AntennaPath& path_;
  std::vector<PlaneFix> fixes_;
};

}  // namespace rigmap
