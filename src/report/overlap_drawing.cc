// From how many images each spot of the map is seen, drawn from above.
#include <fmt/format.h>

#include <algorithm>

#include "report/drawing.h"
#include "report/part_content.h"
#include "report/pictures.h"

namespace rigmap {
namespace {

constexpr double kWidth_px = 560.0, kHeight_px = 460.0;

// 0 to 1 for one image to as many as nineteen in twenty spots have at most; negative where the map
// is empty. The first row of the picture is the highest y.
std::vector<double> Shares(const MapViews& views, int most) {
  std::vector<double> shares;
  for (int row = views.rows - 1; row >= 0; --row) {
    for (int column = 0; column < views.columns; ++column) {
      const int images = views.images[static_cast<std::size_t>(row * views.columns + column)];
      shares.push_back(images == 0 ? -1.0 : std::min(1.0, double(images - 1) / (most - 1)));
    }
  }
  return shares;
}

}  // namespace

std::string OverlapDrawing(const PartContent& content) {
  if (!content.views) return "";
  const MapViews& views = *content.views;
  const int most = std::max(2, views.usual_most_images);
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
  const std::string drawn = fmt::format(
      "<image class=\"cells\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
      "preserveAspectRatio=\"none\" href=\"{}\"/>\n{}{}",
      corner.x(), corner.y(), size_px.x(), size_px.y(),
      ColouredPictureUrl(Shares(views, most), views.columns), DrawLine(path, "path"),
      frame.ScaleBar());
  return fmt::format(
      "<figure>{}<figcaption>Overlap: how many images show each spot of the map, if nothing stands "
      "in between. <span class=\"ramp\">1 <img alt=\"colours from few to many\" src=\"{}\"> {} and "
      "more</span></figcaption></figure>\n",
      DrawingText(frame.width_px(), frame.height_px(), "how many images show each spot", drawn),
      ColouredPictureUrl({0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}, 9), most);
}

}  // namespace rigmap
