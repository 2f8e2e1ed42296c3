// Pictures of a part by which a person recognises the place: its surface and the path driven.
#pragma once

#include <filesystem>

#include "raster/cell_frame.h"
#include "raster/raster_options.h"
#include "scene/trajectory.h"

namespace rigmap {

// Writes folder/view_top.png, view_side.png and view_oblique.png (view_axes.h). Each is at most
// options.picture_px wide and high, has the camera's path drawn over the surface with thin lines
// down to the ground, and a scale bar that holds for all lengths across the view. The view takes in
// the path and all but a few strays of the points; gaps up to 5 cm or five
// cells wide are closed, and the light is strengthened where the ground rises above its
// surroundings. The cloud's warning stands on a red band along the top. Equal inputs give equal
// bytes. Memory (about 200 MB at most for 1600 px) does not grow with the cloud, which is read
// three times. Throws DataError naming the file for a cloud that cannot be read or has no point,
// and where writing fails; old files are then left as they were. Throws UsageError.
void WriteSurfaceViews(const GriddedCloud& cloud, const Trajectory& trajectory,
                       const std::filesystem::path& folder, const PictureOptions& options);

}  // namespace rigmap
