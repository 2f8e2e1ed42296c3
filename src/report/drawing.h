// Drawings as SVG in the colours of the page, which need no scripts.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace rigmap {

// Squares of a matrix, row by row, each in the given opacity of a colour class ("a" or "b") under
// an optional tooltip.
struct MatrixCell {
  double strength = 0.0;  // 0 to 1
  bool is_negative = false;
  std::string tip;
};
struct MatrixDrawing {
  int rows = 0, columns = 0;
  std::vector<std::string> names;  // of rows and columns; empty: none are written
  double cell_px = 10.0;
};
std::string DrawMatrix(const MatrixDrawing& drawing,
                       const std::function<MatrixCell(int row, int column)>& cell);

// A frame of metres, y up, onto pixels of a drawing, y down, as large as fits.
class DrawingFrame {
 public:
  DrawingFrame(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m, double width_px,
               double max_height_px);
  Eigen::Vector2d operator()(const Eigen::Vector2d& x_m) const;
  double px_per_m() const { return px_per_m_; }
  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }
  // A round length about a fifth of the width, with its bar as SVG at the lower left.
  std::string ScaleBar() const;

 private:
  Eigen::Vector2d low_m_;
  double px_per_m_ = 1.0, width_px_ = 0.0, height_px_ = 0.0;
};

// A polyline of at most 2000 of the points.
std::string DrawLine(const std::vector<Eigen::Vector2d>& points_px, const char* css_class);

std::string DrawingText(double width_px, double height_px, const std::string& label,
                        const std::string& content);

}  // namespace rigmap
