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

Eigen::Vector3d LocalFrame::ToEnu(const Geodetic& place) const {
  RequireValid(place);
  Eigen::Vector3d enu;
  impl_->cartesian.Forward(place.latitude_deg, place.longitude_deg, place.altitude_m, enu.x(),
                           enu.y(), enu.z());
  return enu;
}

Geodetic LocalFrame::ToGeodetic(const Eigen::Vector3d& enu) const {
  if (!enu.allFinite()) {
    throw DataError(fmt::format("expected finite metres east, north and up, found {}, {}, {}",
                                enu.x(), enu.y(), enu.z()));
  }
  Geodetic place;
  impl_->cartesian.Reverse(enu.x(), enu.y(), enu.z(), place.latitude_deg, place.longitude_deg,
                           place.altitude_m);
  return place;
}

}  // namespace rigmap
