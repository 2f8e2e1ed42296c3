#include "georeference/route_files.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "core/json_text.h"

namespace rigmap {
namespace {

constexpr int kCorners = 16;  // of a rock's outline: a circle to 2 % of its radius

// Degrees to 1e-9 (0.1 mm), metres to 0.1 mm.
std::string Coordinates(const Geodetic& position) {
  return fmt::format("{:.9f},{:.9f},{:.4f}", position.longitude_deg, position.latitude_deg,
                     position.altitude_m);
}

std::string FlatCoordinates(const Geodetic& position) {
  return fmt::format("{:.9f},{:.9f}", position.longitude_deg, position.latitude_deg);
}

// Where a step from `from` to `to` meets the antimeridian, on the side of `from`.
Geodetic Crossing(const Geodetic& from, const Geodetic& to) {
  const double side_deg = from.longitude_deg > 0.0 ? 180.0 : -180.0;
  const double before_deg = std::abs(side_deg - from.longitude_deg);
  const double share = before_deg / (before_deg + std::abs(-side_deg - to.longitude_deg));
  return {from.latitude_deg + share * (to.latitude_deg - from.latitude_deg), side_deg,
          from.altitude_m + share * (to.altitude_m - from.altitude_m)};
}

// The route, cut where it crosses the antimeridian, as RFC 7946 (3.1.9) asks for.
std::vector<std::vector<Geodetic>> Lines(const std::vector<Geodetic>& positions) {
  std::vector<std::vector<Geodetic>> lines(1);
  for (const Geodetic& position : positions) {
    auto& line = lines.back();
    if (!line.empty() && std::abs(line.back().longitude_deg - position.longitude_deg) > 180.0) {
      const Geodetic before = line.back();
      line.push_back(Crossing(before, position));
      lines.push_back({Crossing(position, before)});
    }
    lines.back().push_back(position);
  }
  return lines;
}

// Counterclockwise from above, closed.
std::vector<Geodetic> Outline(const RouteLandmark& rock, const EarthMap& earth) {
  std::vector<Geodetic> outline;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * (i % kCorners) / kCorners;
    const Eigen::Vector3d arm(std::cos(angle_rad), std::sin(angle_rad), 0.0);
    outline.push_back(earth.ToGeodetic(rock.top_in_world + 0.5 * rock.width_m * arm));
  }
  return outline;
}

std::string Positions(const std::vector<Geodetic>& line) {
  std::vector<std::string> positions;
  for (const Geodetic& position : line)
    positions.push_back(fmt::format("[{}]", Coordinates(position)));
  return fmt::format("[{}]", fmt::join(positions, ","));
}

std::vector<Geodetic> PositionsOf(const Trajectory& trajectory, const EarthMap& earth) {
  std::vector<Geodetic> positions;
  for (const TimedPose& pose : trajectory) {
    positions.push_back(earth.ToGeodetic(pose.world_from_left.translation));
  }
  return positions;
}

// One standard deviation along axes that the world's are turned into.
Eigen::Vector3d SigmasAlong(const TimedPose& pose, double angle_rad) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return (turn * pose.position_covariance * turn.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
}

std::string Feature(const std::string& type, const std::string& coordinates,
                    const std::string& properties) {
  return fmt::format(
      R"({{"type":"Feature","geometry":{{"type":"{}","coordinates":{}}},"properties":{{{}}}}})",
      type, coordinates, properties);
}

std::string RouteFeature(const Route& route, const std::vector<Geodetic>& positions) {
  std::string properties =
      fmt::format(R"("kind":"route","position_sigma_m":{:.4g},"height_sigma_m":{:.4g})",
                  route.position_sigma_m, route.height_sigma_m);
  if (!route.warning.empty()) {
    properties += R"(,"verdict":)" + JsonText(nlohmann::json(route.warning));
  }
  auto lines = Lines(positions);
  // A line has two positions at least.
  for (auto& line : lines) {
    if (line.size() == 1) line.push_back(line.front());
  }
  if (lines.size() == 1) return Feature("LineString", Positions(lines.front()), properties);
  std::vector<std::string> parts;
  for (const auto& line : lines) parts.push_back(Positions(line));
  return Feature("MultiLineString", fmt::format("[{}]", fmt::join(parts, ",")), properties);
}

std::string PoseFeature(const TimedPose& pose, const Geodetic& position, double angle_rad) {
  const Eigen::Vector3d sigma = SigmasAlong(pose, angle_rad);
  std::string properties =
      fmt::format(R"("kind":"pose","stamp_ns":{},"source":"{}")", pose.stamp_ns, Name(pose.source));
  if (sigma.allFinite()) {  // JSON has no number for what is unknown
    properties +=
        fmt::format(R"(,"sigma_east_m":{:.4g},"sigma_north_m":{:.4g},"sigma_up_m":{:.4g})",
                    sigma.x(), sigma.y(), sigma.z());
  }
  return Feature("Point", fmt::format("[{}]", Coordinates(position)), properties);
}

std::string RockFeature(const RouteLandmark& rock, const EarthMap& earth) {
  return Feature("Polygon", fmt::format("[{}]", Positions(Outline(rock, earth))),
                 fmt::format(R"("kind":"rock","width_m":{:.3f},"height_m":{:.3f})", rock.width_m,
                             rock.height_m));
}

std::string KmlLine(const std::vector<Geodetic>& line) {
  std::vector<std::string> positions;
  for (const Geodetic& position : line) positions.push_back(FlatCoordinates(position));
  return fmt::format("{}", fmt::join(positions, " "));
}

// Of text that stands between tags.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return escaped;
}

}  // namespace

std::string WriteTrajectoryUtm(const Trajectory& trajectory, const EarthMap& earth) {
  std::string text = "stamp_ns,easting,northing,height,qx,qy,qz,qw,se,sn,sh,source\n";
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& x_in_world = pose.world_from_left.translation;
    const Eigen::Vector3d grid = earth.ToGrid(x_in_world);
    const double angle_rad = earth.GridAngleAt(x_in_world.head<2>());
    Eigen::Quaterniond q =
        Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * pose.world_from_left.rotation;
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d sigma = SigmasAlong(pose, angle_rad);
    text += fmt::format(
        "{},{:.4f},{:.4f},{:.4f},{:.12f},{:.12f},{:.12f},{:.12f},{:.6g},{:.6g},{:.6g},{}\n",
        pose.stamp_ns, grid.x(), grid.y(), grid.z(), q.x(), q.y(), q.z(), q.w(), sigma.x(),
        sigma.y(), sigma.z(), Name(pose.source));
  }
  return text;
}

std::string WriteRouteGeoJson(const Route& route) {
  const auto positions = PositionsOf(route.trajectory, route.earth);
  std::vector<std::string> features;
  if (!positions.empty()) features.push_back(RouteFeature(route, positions));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    features.push_back(
        PoseFeature(route.trajectory[i], positions[i], route.earth.frame().angle_rad));
  }
  for (const RouteLandmark& rock : route.rocks) features.push_back(RockFeature(rock, route.earth));
  return fmt::format("{{\"type\":\"FeatureCollection\",\"features\":[\n{}\n]}}\n",
                     fmt::join(features, ",\n"));
}

std::string WriteRouteKml(const Route& route) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>route</name>\n";
  if (!route.warning.empty()) {
    text += fmt::format("<description>{}</description>\n", Escaped(route.warning));
  }
  text +=
      "<Style id=\"route\"><LineStyle><color>ff0000ff</color><width>3</width></LineStyle></Style>\n"
      "<Style id=\"rock\"><LineStyle><color>ff00a5ff</color></LineStyle>"
      "<PolyStyle><color>8000a5ff</color></PolyStyle></Style>\n";
  for (const auto& line : Lines(PositionsOf(route.trajectory, route.earth))) {
    text += fmt::format(
        "<Placemark><name>route of the left camera</name><styleUrl>#route</styleUrl>"
        "<LineString><tessellate>1</tessellate><coordinates>{}</coordinates></LineString>"
        "</Placemark>\n",
        KmlLine(line));
  }
  for (const RouteLandmark& rock : route.rocks) {
    text += fmt::format(
        "<Placemark><name>rock</name><description>{:.2f} m wide, {:.2f} m high</description>"
        "<styleUrl>#rock</styleUrl><Polygon><outerBoundaryIs><LinearRing><coordinates>{}"
        "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>\n",
        rock.width_m, rock.height_m, KmlLine(Outline(rock, route.earth)));
  }
  return text + "</Document>\n</kml>\n";
}

}  // namespace rigmap
