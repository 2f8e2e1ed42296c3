#include "raster/surface_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"
#include "export/ply_reader.h"
#include "imaging/image.h"
#include "raster/fill_pinholes.h"
#include "raster/internal/picture_frame.h"
#include "raster/internal/relief_shading.h"
#include "raster/internal/surface_patch.h"
#include "raster/internal/view_axes.h"
#include "raster/upper_surface.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr double kStrayShare = 0.0002;  // of the points, left out of the view at each edge
// Gaps that are closed in pictures: so many metres or, where that is more, cells; pixels at most.
constexpr double kMaxGap_m = 0.05, kMaxGapCells = 5.0, kMaxGapPx = 25.0;
constexpr double kMinView_m = 0.2;          // extent of the smallest view
constexpr std::uint64_t kSamples = 200000;  // points that decide on the extent

struct View {
  std::string name;
  std::string caption;
  ViewAxes axes;
  std::array<RangeCounter, 2> counters{};  // along right and up
  // Set by Frame: view coordinates of the upper left corner, and the scale.
  Eigen::Vector2d upper_left_m = Eigen::Vector2d::Zero();
  double px_per_m = 0.0;
  cv::Size size_px{};

  // From the view's upper left corner.
  Eigen::Vector2d PixelFromView(const Eigen::Vector3d& x_in_view) const {
    return {(x_in_view.x() - upper_left_m.x()) * px_per_m,
            (upper_left_m.y() - x_in_view.y()) * px_per_m};
  }
};

double MaxGap(double cell_m) { return std::max(kMaxGap_m, kMaxGapCells * cell_m); }

std::array<View, 3> Views(const Trajectory& trajectory, double cell_m) {
  const Eigen::Vector3d direction = DrivingDirection(trajectory);
  return {View{"view_top.png",
               fmt::format("From above: x (first heading) to the right, y up; blank: not seen "
                           "({:.0f} cm or more)",
                           100.0 * MaxGap(cell_m)),
               TopView()},
          View{"view_side.png", "From the right, straight across the drive, heights to scale",
               SideView(direction)},
          View{"view_oblique.png", "From behind and above, the scale holds from left to right",
               ObliqueView(direction)}};
}

void CountExtents(const GriddedCloud& cloud, std::array<View, 3>& views) {
  const std::uint64_t stride = PlyReader(cloud.ply).point_count() / kSamples + 1;
  std::uint64_t index = 0;
  ForEachShown(cloud, [&](const SurfacePoint& point) {
    if (index++ % stride != 0) return;
    for (View& view : views) {
      const Eigen::Vector3d x_in_view = view.axes.ViewFromWorld(point.x_in_world.cast<double>());
      for (int i = 0; i < 2; ++i) view.counters[i].Add(x_in_view(i));
    }
  });
  if (index == 0)
    throw DataError(fmt::format("{}: expected points, found none", cloud.ply.string()));
}

// Takes in the points without strays, and the path; the longest side of the picture has its size.
void Frame(const Trajectory& trajectory, int picture_px, View& view) {
  Eigen::Vector2d low, high;
  for (int i = 0; i < 2; ++i) {
    const RangeCounter::Range range = view.counters[i].Trimmed(kStrayShare);
    low(i) = range.low;
    high(i) = range.high;
  }
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector2d x = view.axes.ViewFromWorld(pose.world_from_left.translation).head<2>();
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Eigen::Vector2d extent_m = (high - low).cwiseMax(kMinView_m);
  view.upper_left_m = {low.x(), low.y() + extent_m.y()};
  view.px_per_m = std::min((picture_px - 2 * kMarginPx) / extent_m.x(),
                           (picture_px - 2 * kMarginPx - kFooterPx) / extent_m.y());
  const Eigen::Vector2d size_px = (view.px_per_m * extent_m).array().floor().max(1.0);
  view.size_px = {static_cast<int>(size_px.x()), static_cast<int>(size_px.y())};
}

// Calls take(column, row) for the pixels of a box that lie in the view.
template <class Take>
void ForEachPixel(const View& view, const Eigen::Array2d& low_px, const Eigen::Array2d& high_px,
                  Take take) {
  const Eigen::Array2d limit_px(view.size_px.width - 1, view.size_px.height - 1);
  if (!((low_px < limit_px + 1.0).all() && (high_px >= 0.0).all())) return;
  const Eigen::Array2i first = low_px.floor().max(0.0).cast<int>();
  const Eigen::Array2i last = high_px.floor().min(limit_px).cast<int>();
  for (int row = first.y(); row <= last.y(); ++row) {
    for (int column = first.x(); column <= last.x(); ++column) take(column, row);
  }
}

// Calls take(column, row, nearness) for the pixels of a square towards the viewer, as large as a
// cell and a half, so that neighbours touch.
template <class Take>
void DrawSquare(const View& view, const SurfacePoint& point, double cell_m, Take take) {
  const Eigen::Vector3d x_in_view = view.axes.ViewFromWorld(point.x_in_world.cast<double>());
  const Eigen::Array2d centre_px = view.PixelFromView(x_in_view);
  const double reach_px = 0.75 * cell_m * view.px_per_m;
  ForEachPixel(view, centre_px - reach_px, centre_px + reach_px,
               [&](int column, int row) { take(column, row, x_in_view.z()); });
}

// The same for those of a patch, and a little beyond its edges, so that neighbours touch.
template <class Take>
void DrawPatch(const View& view, const SurfacePatch& patch, Take take) {
  constexpr double kBeyondPx = 0.75;
  const Eigen::Vector3d corner = view.axes.ViewFromWorld(patch.corner);
  const Eigen::Vector2d corner_px = view.PixelFromView(corner);
  Eigen::Matrix2d edges_px;  // in its columns
  Eigen::Vector2d nearness_m;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d edge = view.axes.ViewFromWorld(patch.edges[i]);
    edges_px.col(i) = view.px_per_m * Eigen::Vector2d(edge.x(), -edge.y());
    nearness_m(i) = edge.z();
  }
  const double area_px = std::abs(edges_px.determinant());
  if (!(area_px > 1e-6)) return;  // seen edge on
  const Eigen::Matrix2d share_from_px = edges_px.inverse();
  const Eigen::Array2d beyond =
      kBeyondPx / area_px * Eigen::Array2d(edges_px.col(1).norm(), edges_px.col(0).norm());
  const Eigen::Array2d low_px =
      corner_px.array() + edges_px.array().min(0.0).rowwise().sum() - kBeyondPx;
  const Eigen::Array2d high_px =
      corner_px.array() + edges_px.array().max(0.0).rowwise().sum() + kBeyondPx;
  ForEachPixel(view, low_px, high_px, [&](int column, int row) {
    const Eigen::Vector2d off_px = Eigen::Vector2d(column + 0.5, row + 0.5) - corner_px;
    const Eigen::Array2d share = share_from_px * off_px;
    if ((share < -beyond).any() || (share > 1.0 + beyond).any()) return;
    const Eigen::Vector2d inside = share.max(0.0).min(1.0);
    take(column, row, corner.z() + nearness_m.dot(inside));
  });
}

// What is nearest to the viewer, pixel by pixel.
std::array<SurfaceGrid, 3> Surfaces(const GriddedCloud& cloud, const std::array<View, 3>& views) {
  std::vector<UpperSurface> surfaces;
  for (const View& view : views) {
    const double layer_m = 2.0 * std::max(cloud.cell_m, 1.0 / view.px_per_m);
    surfaces.emplace_back(view.size_px.width, view.size_px.height, layer_m);
  }
  const auto visit = [&](auto deed) {
    ForEachShown(cloud, [&](const SurfacePoint& point) {
      const bool is_coarse = point.IsCoarserThan(cloud.cell_m);
      const bool has_plane = is_coarse && !point.normal.isZero();
      CellSample sample = SampleOf(point, 0.0, cloud.cell_m);
      for (std::size_t i = 0; i < views.size(); ++i) {
        const auto take = [&](int column, int row, double nearness_m) {
          sample.height_m = static_cast<float>(nearness_m);
          deed(surfaces[i], column, row, sample);
        };
        if (has_plane) {
          DrawPatch(views[i], PatchOf(point), take);
        } else {
          DrawSquare(views[i], point, std::max<double>(cloud.cell_m, point.grain_m), take);
        }
      }
    });
  };
  visit([](UpperSurface& surface, int column, int row, const CellSample& sample) {
    surface.Raise(column, row, sample);
  });
  visit([](UpperSurface& surface, int column, int row, const CellSample& sample) {
    surface.Blend(column, row, sample);
  });
  return {surfaces[0].Finish(), surfaces[1].Finish(), surfaces[2].Finish()};
}

// Takes the pixels' nearness for their height in world.
void MeasureUpwards(const View& view, SurfaceGrid& surface) {
  for (int row = 0; row < surface.rows; ++row) {
    const double along_up_m = view.upper_left_m.y() - (row + 0.5) / view.px_per_m;
    for (int column = 0; column < surface.columns; ++column) {
      float& height_m = surface.height_m[surface.Index(column, row)];
      height_m = static_cast<float>(view.axes.up.z() * along_up_m +
                                    view.axes.towards_viewer.z() * height_m);
    }
  }
}

// From a dozen places on the path straight down to the ground, where that was seen: camera, foot.
std::vector<std::array<Eigen::Vector3d, 2>> PlumbLines(const View& top, const SurfaceGrid& ground,
                                                       const Trajectory& trajectory) {
  constexpr std::size_t kLines = 12;
  std::vector<std::array<Eigen::Vector3d, 2>> lines;
  for (std::size_t i = 0; i < trajectory.size(); i += trajectory.size() / kLines + 1) {
    const Eigen::Vector3d& camera = trajectory[i].world_from_left.translation;
    const Eigen::Array2d pixel = top.PixelFromView(top.axes.ViewFromWorld(camera)).array().floor();
    const int column = static_cast<int>(pixel.x()), row = static_cast<int>(pixel.y());
    if (!ground.Holds(column, row)) continue;
    lines.push_back({camera, {camera.x(), camera.y(), ground.height_m[ground.Index(column, row)]}});
  }
  return lines;
}

cv::Mat3b Picture(const GriddedCloud& cloud, const View& view, const SurfaceGrid& surface,
                  const Trajectory& trajectory,
                  const std::vector<std::array<Eigen::Vector3d, 2>>& plumb_lines) {
  Canvas canvas = EmptyCanvas(view.size_px);
  DrawShaded(surface, cloud.cell_m, view.px_per_m, canvas.picture(canvas.view));
  const auto pixel = [&](const Eigen::Vector3d& x_in_world) -> Eigen::Vector2d {
    return view.PixelFromView(view.axes.ViewFromWorld(x_in_world)) +
           Eigen::Vector2d(canvas.view.x, canvas.view.y);
  };
  for (const auto& [camera, foot] : plumb_lines) {
    DrawPlumbLine(canvas.picture, pixel(camera), pixel(foot));
  }
  std::vector<Eigen::Vector2d> path_px;
  for (const TimedPose& pose : trajectory) {
    path_px.push_back(pixel(pose.world_from_left.translation));
  }
  DrawPath(canvas.picture, path_px);
  const bool shows_plumb_lines = !plumb_lines.empty() && view.axes.up.z() > 0.0;
  DrawFooter(canvas, view.px_per_m,
             view.caption + (shows_plumb_lines ? "; thin: down to the ground" : ""));
  if (!cloud.warning.empty()) DrawWarning(canvas.picture, cloud.warning);
  return canvas.picture;
}

}  // namespace

void WriteSurfaceViews(const GriddedCloud& cloud, const Trajectory& trajectory,
                       const fs::path& folder, const PictureOptions& options) {
  cloud.Validate();
  RequireValid(options);
  std::array<View, 3> views = Views(trajectory, cloud.cell_m);
  CountExtents(cloud, views);
  for (View& view : views) Frame(trajectory, options.picture_px, view);
  std::array<SurfaceGrid, 3> surfaces = Surfaces(cloud, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double gap_px = std::min(MaxGap(cloud.cell_m) * views[i].px_per_m, kMaxGapPx);
    FillPinholes(surfaces[i], 1 + static_cast<int>(gap_px));
    MeasureUpwards(views[i], surfaces[i]);
  }
  const auto plumb_lines = PlumbLines(views[0], surfaces[0], trajectory);
  for (std::size_t i = 0; i < views.size(); ++i) {
    WriteImage(folder / views[i].name,
               Picture(cloud, views[i], surfaces[i], trajectory, plumb_lines));
  }
}

}  // namespace rigmap
