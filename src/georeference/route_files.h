// The route of a camera over the Earth, and what stands beside it, as maps take it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "georeference/earth_frame.h"
#include "scene/trajectory.h"

namespace rigmap {

// Something found in the map, round as seen from above. World axes, metres.
struct RouteLandmark {
  Eigen::Vector3d top_in_world = Eigen::Vector3d::Zero();
  double width_m = 0.0;
  double height_m = 0.0;  // above the ground
};

// What all files of a route say. Kept by reference.
struct Route {
  const Trajectory& trajectory;
  const EarthMap& earth;
  std::span<const RouteLandmark> rocks;
  // One sigma of where the whole lies, horizontally per axis and in height, m.
  double position_sigma_m = 0.0, height_sigma_m = 0.0;
  std::string warning = {};  // what everything made of it has to bear; empty: nothing
};

// trajectory_utm.csv: a header line, then one line per pose:
//   stamp_ns                  integer, UTC
//   easting,northing,height   of the left camera on the grid of the zone, height above the
//                             ellipsoid, metres
//   qx,qy,qz,qw               grid_from_left: its axes against the grid's east and north and up
//   se,sn,sh                  one standard deviation along these, metres, relative to the first
//                             posed frame
//   source                    adjusted, odometry or predicted
std::string WriteTrajectoryUtm(const Trajectory& trajectory, const EarthMap& earth);

// route.geojson (RFC 7946): the route as a LineString (MultiLineString across the antimeridian),
// then each pose as a Point with stamp_ns, source, sigma_east_m, sigma_north_m, sigma_up_m, and
// each rock as a Polygon of sixteen sides with width_m and height_m. Longitude, latitude, metres
// above the ellipsoid.
std::string WriteRouteGeoJson(const Route& route);

// route.kml (OGC KML 2.2): the route and the rocks on the ground. Without heights: KML counts them
// from the sea, which is tens of metres from the ellipsoid.
std::string WriteRouteKml(const Route& route);

}  // namespace rigmap
