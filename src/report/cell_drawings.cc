// What is known of each spot of the map, drawn from above in cells.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "report/drawing.h"
#include "report/part_content.h"
#include "report/pictures.h"

namespace rigmap {
namespace {

constexpr double kWidth_px = 560.0, kHeight_px = 460.0;

// 0 to 1 between two values, row by row as a picture has them: the highest y first. Negative for
// cells that are empty, whose value is not a number.
std::vector<double> Shares(const MapViews& views, const std::vector<double>& values, double low,
                           double high) {
  std::vector<double> shares;
  for (int row = views.rows - 1; row >= 0; --row) {
    for (int column = 0; column < views.columns; ++column) {
      const double value = values[static_cast<std::size_t>(row * views.columns + column)];
      shares.push_back(std::isnan(value) ? -1.0
                                         : std::clamp((value - low) / (high - low), 0.0, 1.0));
    }
  }
  return shares;
}

// The cells with the path upon them and a bar of length.
std::string DrawCells(const PartContent& content, const std::vector<double>& shares,
                      const char* label) {
  const MapViews& views = *content.views;
  const Eigen::Vector2d size_m = views.cell_m * Eigen::Vector2d(views.columns, views.rows);
  Eigen::Vector2d low_m = views.low_m, high_m = views.low_m + size_m;
  for (const TimedPose& pose : content.folder.trajectory) {
    low_m = low_m.cwiseMin(pose.world_from_left.translation.head<2>());
    high_m = high_m.cwiseMax(pose.world_from_left.translation.head<2>());
  }
  const DrawingFrame frame(low_m, high_m, kWidth_px, kHeight_px);
  const Eigen::Vector2d corner = frame(views.low_m + Eigen::Vector2d(0.0, size_m.y()));
  const Eigen::Vector2d size_px = frame.px_per_m() * size_m;
  std::vector<Eigen::Vector2d> path;
  for (const TimedPose& pose : content.folder.trajectory) {
    path.push_back(frame(pose.world_from_left.translation.head<2>()));
  }
  return DrawingText(
      frame.width_px(), frame.height_px(), label,
      fmt::format("<image class=\"cells\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                  "height=\"{:.1f}\" preserveAspectRatio=\"none\" href=\"{}\"/>\n{}{}",
                  corner.x(), corner.y(), size_px.x(), size_px.y(),
                  ColouredPictureUrl(shares, views.columns), DrawLine(path, "path"),
                  frame.ScaleBar()));
}

std::string Ramp(const std::string& low, const std::string& high) {
  return fmt::format(
      "<span class=\"ramp\">{} <img alt=\"colours from low to high\" src=\"{}\"> {}</span>", low,
      ColouredPictureUrl({0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}, 9), high);
}

std::string OverlapDrawing(const PartContent& content) {
  const MapViews& views = *content.views;
  const int most = std::max(2, views.usual_most_images);
  std::vector<double> images;
  for (const int count : views.images) {
    images.push_back(count > 0 ? count : std::numeric_limits<double>::quiet_NaN());
  }
  return fmt::format(
      "<figure>{}<figcaption>Overlap: how many images show each spot of the map, if nothing stands "
      "in between. {}</figcaption></figure>\n",
      DrawCells(content, Shares(views, images, 1.0, most), "how many images show each spot"),
      Ramp("1", fmt::format("{} and more", most)));
}

std::string HeightDrawing(const PartContent& content) {
  constexpr double kTailShare = 0.02;
  const MapViews& views = *content.views;
  std::vector<double> known;
  for (const double height_m : views.heights_m) {
    if (!std::isnan(height_m)) known.push_back(height_m);
  }
  const double low_m = Quantile(known, kTailShare);
  const double high_m = std::max(Quantile(known, 1.0 - kTailShare), low_m + 1e-3);
  return fmt::format(
      "<figure>{}<figcaption>Height of the map, world z; what is higher or lower has the colours "
      "of the ends. {}</figcaption></figure>\n",
      DrawCells(content, Shares(views, views.heights_m, low_m, high_m), "how high the map is"),
      Ramp(fmt::format("{:.2f} m", low_m), fmt::format("{:.2f} m", high_m)));
}

}  // namespace

std::string CellDrawings(const PartContent& content) {
  return content.views ? OverlapDrawing(content) + HeightDrawing(content) : "";
}

}  // namespace rigmap
