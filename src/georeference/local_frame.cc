#include "georeference/local_frame.h"

#include <fmt/format.h>

#include <GeographicLib/LocalCartesian.hpp>

#include "core/error.h"

namespace rigmap {

struct LocalFrame::Impl {
  GeographicLib::LocalCartesian cartesian;
};

LocalFrame::LocalFrame(const Geodetic& origin) : origin_(origin) {
  RequireValid(origin);
  impl_ = std::make_unique<const Impl>(
      Impl{{origin.latitude_deg, origin.longitude_deg, origin.altitude_m}});
}

LocalFrame::~LocalFrame() = default;
LocalFrame::LocalFrame(LocalFrame&&) noexcept = default;
LocalFrame& LocalFrame::operator=(LocalFrame&&) noexcept = default;

Eigen::Vector3d LocalFrame::ToEnu(const Geodetic& position) const {
  RequireValid(position);
  Eigen::Vector3d enu;
  impl_->cartesian.Forward(position.latitude_deg, position.longitude_deg, position.altitude_m,
                           enu.x(), enu.y(), enu.z());
  return enu;
}

Geodetic LocalFrame::ToGeodetic(const Eigen::Vector3d& enu) const {
  if (!enu.allFinite()) {
    throw DataError(fmt::format("expected finite metres east, north and up, found {}, {}, {}",
                                enu.x(), enu.y(), enu.z()));
  }
  Geodetic position;
  impl_->cartesian.Reverse(enu.x(), enu.y(), enu.z(), position.latitude_deg, position.longitude_deg,
                           position.altitude_m);
  return position;
}

}  // namespace rigmap
