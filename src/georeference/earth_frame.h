// Where a metric world lies on Earth.
#pragma once

#include <Eigen/Geometry>

#include "georeference/local_frame.h"
#include "georeference/utm_grid.h"

namespace rigmap {

// The world turned about its own z, which is taken as up, and moved: enu_from_world.
struct EarthFrame {
  Geodetic origin;                                        // of the east-north-up frame
  double angle_rad = 0.0;                                 // from east to the world's x, to north
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // of the world's origin, enu, m
  UtmZone zone;                                           // that maps are drawn in

  Eigen::Vector3d EnuFromWorld(const Eigen::Vector3d& x_in_world) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(origin.latitude_deg, origin.longitude_deg, origin.altitude_m, angle_rad,
            translation.x(), translation.y(), translation.z(), zone);
  }
};

// Metres east and north on the zone's grid and above the ellipsoid, affine in the world's plane;
// heights with the Earth's curvature. Off by d^2 / 2 of the change of the grid's scale per metre
// (at most 8e-9) from the exact conversion d metres from the centre, 4 mm at 1 km, and by d / 6400
// km of the height above the world's z = 0.
struct GridFrame {
  int epsg = 0;
  Eigen::Affine2d grid_from_world = Eigen::Affine2d::Identity();
  Eigen::Vector2d origin_in_world = Eigen::Vector2d::Zero();  // where the plane touches the Earth
  double height_m = 0.0;                                      // of the world's z = 0 there
  double curvature_per_m = 0.0;                               // half the inverse of Earth's radius

  Eigen::Vector3d GridFromWorld(const Eigen::Vector3d& x_in_world) const;
};

// Conversions of points of the world. Immutable and thread-safe.
class EarthMap {
 public:
  explicit EarthMap(const EarthFrame& frame);  // throws DataError for an origin that is no place

  Geodetic ToGeodetic(const Eigen::Vector3d& x_in_world) const;
  // Easting, northing, height above the ellipsoid: metres, exact.
  Eigen::Vector3d ToGrid(const Eigen::Vector3d& x_in_world) const;
  // From the grid's east to the world's x, to north, at a point of the world: rad.
  double GridAngleAt(const Eigen::Vector2d& x_in_world) const;
  // The same, exact around a point of the world.
  GridFrame GridAround(const Eigen::Vector2d& x_in_world) const;

  const EarthFrame& frame() const { return frame_; }

 private:
  EarthFrame frame_;
  LocalFrame plane_;
};

}  // namespace rigmap
