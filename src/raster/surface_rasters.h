// The map of a part or traverse as GeoTIFF files: the height of its surface, its colours seen from
// above, and what driving over it means.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/camera.h"
#include "georeference/earth_frame.h"
#include "raster/cell_frame.h"
#include "raster/raster_options.h"
#include "scene/trajectory.h"

namespace rigmap {

// What rasters take beside the cloud.
struct RasterInputs {
  // The cameras that saw it, for view angles; null: unknown. Kept by reference.
  const Trajectory* trajectory = nullptr;
  const Camera* left_camera = nullptr;
  std::optional<GridFrame> grid = {};  // where it lies on Earth; nothing: in the world's own metres
  std::string up = {};  // what told which way is up, for the metadata RIGMAP_UP; empty: unsaid
};

// Writes folder/height.tif, ortho.tif and terrain.tif, cloud-optimised GeoTIFFs. Cells as in
// UpperSurface, with layers as thick as a cell.
//   height.tif   Float32, nodata -9999: "height" (m; above the ellipsoid on a grid of the Earth),
//                "sigma" (m: of one measurement off its surface, root mean square), "count" (depth
//                pixels; 0: filled in), "view_angle" (degrees between the normal and the nearest
//                camera that has the cell in its image)
//   ortho.tif    red, green, blue, alpha of the same cells; alpha 0 where nothing was seen
//   terrain.tif  Float32, nodata -9999, cells an eighth of the footprint or somewhat finer, of the
//                ground under it (footprint.h): "slope" (degrees), "roughness", "step_height" (m),
//                "slope_exceeds_limit" (probability); metadata RIGMAP_FOOTPRINT_M,
//                RIGMAP_MAX_SLOPE_DEG and RIGMAP_UP
// All bear the cloud's warning (MapFile). North-up, on the grid with its EPSG number, else in world
// with a local system, "rigmap world". terrain.footprint_m must not be 0. Equal inputs give equal
// bytes. Memory does not grow with the cloud (about 200 MB); the folder needs room for the
// uncompressed maps and two thirds of the cloud in passing, in a subfolder whose name
// IsTemporaryName knows. Throws DataError naming the file for a cloud that cannot be read, has no
// point or spreads too far (FrameOf), and where writing fails; old files are then left as they
// were. Throws UsageError. A second call in the process waits for the first.
void WriteSurfaceRasters(const GriddedCloud& cloud, const std::filesystem::path& folder,
                         const RasterOptions& options, const FootprintOptions& terrain,
                         const RasterInputs& inputs = {});

}  // namespace rigmap
