// Local metres around a place: x east, y north, z up (`enu`).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "georeference/geodetic.h"

namespace rigmap {

// The Cartesian frame whose x-y plane touches WGS84 (raised to the origin's altitude) at the
// origin. Straight, not curved: a place on the sea 1 km away has z = -8 cm. Immutable and
// thread-safe. Conversions are exact to nanometres near the origin.
class LocalFrame {
 public:
  // Throws DataError for an origin that is no place (RequireValid).
  explicit LocalFrame(const Geodetic& origin);
  ~LocalFrame();
  LocalFrame(LocalFrame&&) noexcept;
  LocalFrame& operator=(LocalFrame&&) noexcept;

  // Metres. Throws DataError as RequireValid does.
  Eigen::Vector3d ToEnu(const Geodetic& position) const;
  // Longitude within -180 and 180. Throws DataError unless `enu` (metres) is finite.
  Geodetic ToGeodetic(const Eigen::Vector3d& enu) const;

  const Geodetic& origin() const { return origin_; }

 private:
  struct Impl;
  Geodetic origin_;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rigmap
