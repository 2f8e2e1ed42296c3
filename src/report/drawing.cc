#include "report/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/html.h"

namespace rigmap {
namespace {

constexpr double kMargin_px = 24.0;
constexpr double kLetter_px = 7.0;
constexpr std::size_t kMostPointsOfLine = 2000;

}  // namespace

std::string DrawMatrix(const MatrixDrawing& drawing,
                       const std::function<MatrixCell(int, int)>& cell) {
  std::size_t longest = 0;
  for (const std::string& name : drawing.names) longest = std::max(longest, name.size());
  const double left = kLetter_px * static_cast<double>(longest) + (longest ? 6.0 : 0.0);
  std::string content;
  for (int row = 0; row < drawing.rows; ++row) {
    if (longest) {
      content += fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" class=\"name\">{}</text>", left - 6.0,
                             drawing.cell_px * (row + 0.72),
                             Escaped(drawing.names[static_cast<std::size_t>(row)]));
    }
    for (int column = 0; column < drawing.columns; ++column) {
      const MatrixCell one = cell(row, column);
      if (one.strength <= 0.004) continue;
      content += fmt::format(
          "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" class=\"{}\" "
          "opacity=\"{:.2f}\"{}",
          left + drawing.cell_px * column, drawing.cell_px * row, drawing.cell_px, drawing.cell_px,
          one.is_negative ? 'b' : 'a', std::min(one.strength, 1.0),
          one.tip.empty() ? "/>\n" : fmt::format("><title>{}</title></rect>\n", Escaped(one.tip)));
    }
  }
  const double width = drawing.cell_px * drawing.columns, height = drawing.cell_px * drawing.rows;
  content += fmt::format(
      "<rect x=\"{:.1f}\" y=\"0.5\" width=\"{:.0f}\" height=\"{:.0f}\" class=\"edge\"/>", left,
      width - 1.0, height - 1.0);
  return DrawingText(left + width, height, "matrix", content);
}

DrawingFrame::DrawingFrame(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m,
                           double width_px, double max_height_px)
    : low_m_(low_m), width_px_(width_px) {
  const Eigen::Vector2d size_m = (high_m - low_m).cwiseMax(1e-3);
  px_per_m_ = std::min((width_px - 2.0 * kMargin_px) / size_m.x(),
                       (max_height_px - 3.0 * kMargin_px) / size_m.y());
  height_px_ = std::max(px_per_m_ * size_m.y() + 3.0 * kMargin_px, 160.0);
  // In the middle of what is left over.
  low_m_.x() -= 0.5 * (width_px - 2.0 * kMargin_px - px_per_m_ * size_m.x()) / px_per_m_;
  low_m_.y() -= 0.5 * (height_px_ - 3.0 * kMargin_px - px_per_m_ * size_m.y()) / px_per_m_;
}

Eigen::Vector2d DrawingFrame::operator()(const Eigen::Vector2d& x_m) const {
  return {kMargin_px + px_per_m_ * (x_m.x() - low_m_.x()),
          height_px_ - 2.0 * kMargin_px - px_per_m_ * (x_m.y() - low_m_.y())};
}

std::string DrawingFrame::ScaleBar() const {
  const double wanted = 0.2 * width_px_ / px_per_m_;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double length_m = power * (wanted / power >= 5.0 ? 5.0 : wanted / power >= 2.0 ? 2.0 : 1.0);
  const double y = height_px_ - 14.0;
  return fmt::format(
      "<path class=\"scale\" d=\"M{0:.1f} {1:.1f}v6H{2:.1f}v-6\"/>"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\">{5:g} m</text>",
      kMargin_px, y - 3.0, kMargin_px + px_per_m_ * length_m,
      kMargin_px + px_per_m_ * length_m + 8.0, y + 4.0, length_m);
}

std::string DrawLine(const std::vector<Eigen::Vector2d>& points_px, const char* css_class) {
  if (points_px.size() < 2) return "";
  const std::size_t every = points_px.size() / kMostPointsOfLine + 1;
  std::string points;
  for (std::size_t i = 0; i < points_px.size(); ++i) {
    if (i % every != 0 && i + 1 != points_px.size()) continue;
    points += fmt::format("{:.1f},{:.1f} ", points_px[i].x(), points_px[i].y());
  }
  return fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", css_class, points);
}

std::string DrawingText(double width_px, double height_px, const std::string& label,
                        const std::string& content) {
  return fmt::format(
      "<svg class=\"drawing\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\" "
      "width=\"{:.0f}\" height=\"{:.0f}\">\n{}</svg>\n",
      label, width_px, height_px, width_px, height_px, content);
}

}  // namespace rigmap
