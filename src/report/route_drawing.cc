#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/drawing.h"
#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

constexpr double kRouteWidth_px = 1140.0, kRouteHeight_px = 560.0;
constexpr std::size_t kMostEllipses = 80;
constexpr double kLargestEllipse_px = 22.0;

using Points = std::vector<Eigen::Vector2d>;

// The horizontal positions of rows [stamp, x, y, z].
Points Horizontal(const Json& rows) {
  Points points;
  for (const Json& row : rows) {
    if (row.is_array() && row.size() >= 3) points.emplace_back(row[1], row[2]);
  }
  return points;
}

Points Mapped(const Points& points, const DrawingFrame& frame) {
  Points mapped;
  for (const Eigen::Vector2d& point : points) mapped.push_back(frame(point));
  return mapped;
}

// Sigmas along the axes of the world, so many times enlarged that the largest can be seen: a power
// of ten times 1, 2 or 5.
double Enlargement(const Trajectory& trajectory, double px_per_m) {
  double largest_m = 0.0;
  for (const TimedPose& pose : trajectory) {
    largest_m = std::max(largest_m, pose.sigmas.head<2>().maxCoeff());
  }
  if (!(largest_m > 0.0)) return 0.0;
  const double wanted = kLargestEllipse_px / (largest_m * px_per_m);
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  return std::max(1.0, power * (wanted / power >= 5.0 ? 5.0 : wanted / power >= 2.0 ? 2.0 : 1.0));
}

std::string DrawEllipses(const Trajectory& trajectory, const DrawingFrame& frame, double times) {
  std::string ellipses;
  const std::size_t every = trajectory.size() / kMostEllipses + 1;
  for (std::size_t i = 0; i < trajectory.size(); i += every) {
    const TimedPose& pose = trajectory[i];
    const Eigen::Vector2d at = frame(pose.world_from_left.translation.head<2>());
    const Eigen::Vector2d radii = times * frame.px_per_m() * pose.sigmas.head<2>();
    if (!(radii.maxCoeff() > 0.5) || radii.maxCoeff() > 10.0 * kLargestEllipse_px) continue;
    ellipses += fmt::format(
        "<ellipse class=\"sigma\" cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"{:.1f}\" ry=\"{:.1f}\">"
        "<title>frame {}: sigmas {:.1f}, {:.1f} mm</title></ellipse>\n",
        at.x(), at.y(), radii.x(), radii.y(), i, 1000.0 * pose.sigmas[0], 1000.0 * pose.sigmas[1]);
  }
  return ellipses;
}

std::string DrawRocks(const PartContent& content, const DrawingFrame& frame) {
  std::string rocks;
  if (content.cloud && content.cloud->rocks) {
    for (const SegmentedRock& rock : *content.cloud->rocks) {
      const Eigen::Vector2d at = frame(rock.centre);
      rocks += fmt::format(
          "<circle class=\"rock\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"><title>{:.2f} m high, "
          "{:.2f} m wide</title></circle>\n",
          at.x(), at.y(), std::max(2.0, 0.5 * rock.width_m * frame.px_per_m()), rock.height_m,
          rock.width_m);
    }
  }
  for (const Json& rock : At(content.folder.reference, "/rocks")) {
    const Eigen::Vector2d at = frame({rock["x"].get<double>(), rock["y"].get<double>()});
    rocks += fmt::format(
        "<path class=\"surveyed\" d=\"M{:.1f} {:.1f}m-5 -5l10 10m0 -10l-10 10\"><title>{} rock, as "
        "known from elsewhere</title></path>\n",
        at.x(), at.y(), TextAt(rock, "/size"));
  }
  return rocks;
}

Points RockCentres(const PartContent& content) {
  Points centres;
  if (content.cloud && content.cloud->rocks) {
    for (const SegmentedRock& rock : *content.cloud->rocks) centres.push_back(rock.centre);
  }
  return centres;
}

std::string LegendOf(const PartContent& content, double times) {
  std::string legend = "<span><i class=\"key path\"></i>path</span>";
  const auto add = [&](bool is_there, const char* key, const std::string& text) {
    if (is_there) legend += fmt::format("<span><i class=\"key {}\"></i>{}</span>", key, text);
  };
  const Json& reference = content.folder.reference;
  add(reference.contains("truth"), "truth", "true path");
  add(reference.contains("prism"), "truth", "track of the prism");
  add(reference.contains("rtk"), "rtk", "RTK fixes");
  add(content.cloud && content.cloud->rocks && !content.cloud->rocks->empty(), "rock",
      "rocks of the map");
  add(reference.contains("rocks"), "surveyed", "rocks known from elsewhere");
  add(times > 0.0, "sigma", fmt::format("sigmas along x and y, {:g} times enlarged", times));
  return "<p class=\"legend-line\">" + legend + "</p>\n";
}

std::string DrawMark(const Eigen::Vector2d& at, const char* name) {
  return fmt::format(
      "<circle class=\"start\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\"/>"
      "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
      at.x(), at.y(), at.x() + 8.0, at.y() - 7.0, name);
}

}  // namespace

std::string RouteDrawing(const PartContent& content) {
  const Trajectory& trajectory = content.folder.trajectory;
  if (trajectory.size() < 2) return "";
  const Json& reference = content.folder.reference;
  Points path;
  for (const TimedPose& pose : trajectory) {
    path.emplace_back(pose.world_from_left.translation.head<2>());
  }
  const Points truth = Horizontal(At(reference, reference.contains("truth") ? "/truth" : "/prism"));
  const Points fixes = Horizontal(At(reference, "/rtk"));
  Eigen::Vector2d low = path.front(), high = path.front();
  for (const Points* points : std::initializer_list<const Points*>{&path, &truth, &fixes}) {
    for (const Eigen::Vector2d& point : *points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  // Rocks beside the path belong into the picture, those far away do not.
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(0.35 * (high - low).maxCoeff());
  const Eigen::Vector2d near_low = low - reach, near_high = high + reach;
  for (const Eigen::Vector2d& rock : RockCentres(content)) {
    if ((rock.array() < near_low.array()).any() || (rock.array() > near_high.array()).any())
      continue;
    low = low.cwiseMin(rock);
    high = high.cwiseMax(rock);
  }
  const double margin_m = 0.06 * (high - low).maxCoeff();
  const DrawingFrame frame(low - Eigen::Vector2d::Constant(margin_m),
                           high + Eigen::Vector2d::Constant(margin_m), kRouteWidth_px,
                           kRouteHeight_px);
  const double times = Enlargement(trajectory, frame.px_per_m());
  std::string drawn = DrawRocks(content, frame) + DrawEllipses(trajectory, frame, times) +
                      DrawLine(Mapped(truth, frame), "truth") +
                      DrawLine(Mapped(path, frame), "path");
  for (const Eigen::Vector2d& fix : Mapped(fixes, frame)) {
    drawn += fmt::format("<circle class=\"rtk\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", fix.x(),
                         fix.y());
  }
  drawn += DrawMark(frame(path.front()), "start") + DrawMark(frame(path.back()), "end");
  return DrawingText(frame.width_px(), frame.height_px(), "the route from above",
                     drawn + frame.ScaleBar()) +
         LegendOf(content, times);
}

}  // namespace rigmap
