// The route with its curves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/html.h"
#include "report/part_content.h"
#include "report/rounded.h"

namespace rigmap {
namespace {

Json Chart(const char* id, const Json& x, const char* x_label, const char* y_label, Json series) {
  return {{"id", id},
          {"x", {{"label", x_label}, {"values", x}}},
          {"yLabel", y_label},
          {"series", std::move(series)}};
}

Json Series(const char* label, Json values) {
  return {{"label", label}, {"values", std::move(values)}};
}

Json SigmaSeries(const Trajectory& trajectory) {
  Json series = Json::array();
  for (const auto& [name, axis] : {std::pair{"x", 0}, std::pair{"y", 1}, std::pair{"z", 2}}) {
    series.push_back(Series(name, Values(trajectory, [axis = axis](const TimedPose& pose) {
                              return Rounded5(1000.0 * pose.sigmas[axis]);
                            })));
  }
  return series;
}

// The true position at each pose's time, between its neighbours in `rows`; nothing outside, but for
// a first row a little behind the first pose.
std::optional<Eigen::Vector3d> TruthAt(const Json& rows, StampNs stamp_ns) {
  const auto stamp_of = [](const Json& row) { return row[0].get<StampNs>(); };
  const auto after = std::ranges::lower_bound(rows, stamp_ns, {}, stamp_of);
  const auto position = [](const Json& row) { return Eigen::Vector3d(row[1], row[2], row[3]); };
  if (after == rows.end()) return std::nullopt;
  if (stamp_of(*after) == stamp_ns) return position(*after);
  constexpr StampNs kMatch_ns = 20'000'000;  // the first may lie a little behind the first pose
  if (after == rows.begin()) {
    return stamp_of(*after) - stamp_ns < kMatch_ns ? std::optional(position(*after)) : std::nullopt;
  }
  const auto before = std::prev(after);
  const double share = static_cast<double>(stamp_ns - stamp_of(*before)) /
                       static_cast<double>(stamp_of(*after) - stamp_of(*before));
  return (1.0 - share) * position(*before) + share * position(*after);
}

Json ErrorSeries(const Trajectory& trajectory, const Json& truth) {
  Json horizontal = Json::array(), vertical = Json::array();
  for (const TimedPose& pose : trajectory) {
    const auto there = TruthAt(truth, pose.stamp_ns);
    if (!there) {
      horizontal.push_back(nullptr);
      vertical.push_back(nullptr);
      continue;
    }
    const Eigen::Vector3d error = pose.world_from_left.translation - *there;
    horizontal.push_back(Rounded5(1000.0 * error.head<2>().norm()));
    vertical.push_back(Rounded5(1000.0 * error.z()));
  }
  return {Series("horizontal", horizontal), Series("height", vertical)};
}

// Each fix's horizontal distance from the path at its time, over the distance driven.
Json FixChart(const Trajectory& trajectory, const std::vector<double>& distances,
              const Json& fixes) {
  Json distance = Json::array(), off = Json::array();
  double last = -1.0;
  for (const Json& fix : fixes) {
    const auto stamp_ns = fix[0].get<StampNs>();
    const auto after = std::ranges::upper_bound(trajectory, stamp_ns, {}, &TimedPose::stamp_ns);
    if (after == trajectory.begin() || after == trajectory.end()) continue;
    const auto before = std::prev(after);
    const double share = static_cast<double>(stamp_ns - before->stamp_ns) /
                         static_cast<double>(after->stamp_ns - before->stamp_ns);
    const auto between = [&](const auto& from, const auto& to) {
      return ((1.0 - share) * from + share * to);
    };
    const Eigen::Vector2d there = between(before->world_from_left.translation.head<2>().eval(),
                                          after->world_from_left.translation.head<2>().eval());
    const auto index = static_cast<std::size_t>(before - trajectory.begin());
    last =
        std::max(ToTenthOfMillimetre(between(distances[index], distances[index + 1])), last + 1e-6);
    distance.push_back(last);
    off.push_back(Rounded5(1000.0 * (Eigen::Vector2d(fix[1], fix[2]) - there).norm()));
  }
  return Chart("fixes", distance, "distance driven, m", "distance, mm",
               {Series("RTK fixes, horizontally", off)});
}

Json PointSeries(const Trajectory& trajectory, const SparseStatistics& statistics) {
  const auto value = [&](const TimedPose& pose) -> Json {
    const auto image = statistics.images.find(pose.stamp_ns);
    return image == statistics.images.end() ? Json(nullptr) : Json(image->second.points);
  };
  return {Series("sparse points in the left image", Values(trajectory, value))};
}

}  // namespace

Json Charts(const PartContent& content) {
  const Trajectory& trajectory = content.folder.trajectory;
  if (trajectory.size() < 3) return Json::array();
  Json distance = Json::array(), frame = Json::array();
  double last = -1.0;
  for (const double metres : DistancesAlong(trajectory)) {
    last =
        std::max(ToTenthOfMillimetre(metres), last + 1e-6);  // a rover that stands: still in order
    distance.push_back(last);
    frame.push_back(frame.size());
  }
  constexpr const char* kDistance = "distance driven, m";
  Json charts = Json::array();
  const auto height = [](const TimedPose& pose) {
    return ToTenthOfMillimetre(pose.world_from_left.translation.z());
  };
  charts.push_back(Chart("height", distance, kDistance, "height, m",
                         {Series("height of the left camera", Values(trajectory, height))}));
  if (std::ranges::any_of(trajectory, [](const auto& pose) {
        return pose.sigmas.allFinite() && !pose.sigmas.isZero();
      })) {
    charts.push_back(
        Chart("sigmas", distance, kDistance, "sigma of the position, mm", SigmaSeries(trajectory)));
  }
  if (const Json& truth = At(content.folder.reference, "/truth"); truth.size() > 1) {
    charts.push_back(
        Chart("errors", distance, kDistance, "error, mm", ErrorSeries(trajectory, truth)));
  }
  if (const Json& fixes = At(content.folder.reference, "/rtk"); fixes.size() > 1) {
    charts.push_back(FixChart(trajectory, DistancesAlong(trajectory), fixes));
  }
  if (content.sparse) {
    charts.push_back(Chart("points-per-frame", frame, "frame", "points",
                           PointSeries(trajectory, *content.sparse)));
  }
  return charts;
}

std::string RouteSection(const PartContent& content) {
  const std::string route = RouteDrawing(content);
  if (route.empty()) return "";
  std::string body = "<figure>" + route + "</figure>\n";
  const FigureSource evaluation = content.folder.Evaluation();
  if (HasFigure(evaluation, "/ate_se3_m")) {
    body += fmt::format("<p>Off the true path by {} (RMS), which is {} of its length.</p>\n",
                        Figure(evaluation, "/ate_se3_m", Quantity::kMetres),
                        Figure(evaluation, "/ate_se3_pct", Quantity::kPercent));
    body += "<h3>Error over distance</h3>\n<div data-chart=\"errors\"></div>\n";
  }
  if (At(content.folder.reference, "/rtk").size() > 1) {
    body +=
        "<h3>Fixes over distance</h3>\n<p>Horizontally, after the rigid motion that lays the path "
        "on them; those that were not used are among them.</p>\n"
        "<div data-chart=\"fixes\"></div>\n";
  }
  body +=
      "<h3>Sigma over distance</h3>\n<div data-chart=\"sigmas\"></div>\n"
      "<h3>Height over distance</h3>\n<div data-chart=\"height\"></div>\n";
  return HtmlSection(
      "route", "The route",
      "From above, in metres of the world: x is where the first camera looked. "
      "Sigmas are one standard deviation relative to the start" +
          std::string(IsCalibrationInSigmas(content)
                          ? "."
                          : ", of the way from pose to pose alone: what the calibration "
                            "leaves unknown, which the verdict counts, is not in them."),
      body);
}

}  // namespace rigmap
