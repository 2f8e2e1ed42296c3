// The map of a part as GeoTIFF files: the height of its surface, and its colours seen from above.
#pragma once

#include <filesystem>

#include "raster/geotiff.h"
#include "raster/raster_options.h"

namespace rigmap {

// Writes folder/height.tif and folder/ortho.tif, cloud-optimised GeoTIFFs of the same cells. Cells
// as in UpperSurface, with layers as thick as a cell.
//   height.tif  Float32, metres, nodata -9999
//   ortho.tif   red, green, blue, alpha; alpha 0 where nothing was seen
// Both bear the cloud's warning in their metadata (MapFile). North-up in world; without a
// `georeference` the coordinate system is a local one, "rigmap world". Equal clouds and options
// give equal bytes. Memory does not grow with the cloud (about 150 MB); the folder needs room for
// the uncompressed map and half the cloud in passing, in a subfolder whose name IsTemporaryName
// knows. Throws DataError naming the file for a cloud that cannot be read, has no point or spreads
// too far (FrameOf), and where writing fails; old files are then left as they were. Throws
// UsageError. A second call in the process waits for the first.
void WriteSurfaceRasters(const GriddedCloud& cloud, const std::filesystem::path& folder,
                         const RasterOptions& options, const Georeference& georeference = {});

}  // namespace rigmap
