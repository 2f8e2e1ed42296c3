#include "raster/raster_options.h"

namespace rigmap {

void RasterOptions::Validate() const {
  RequireOption(cell_m >= 1e-4 && cell_m <= 1000.0, "raster.cell_m", "0.0001 to 1000", cell_m);
  RequireOption(max_hole_cells >= 0 && max_hole_cells <= 100, "raster.max_hole_cells", "0 to 100",
                max_hole_cells);
  RequireOption(picture_px >= 1000 && picture_px <= 4096, "raster.picture_px", "1000 to 4096",
                picture_px);
}

}  // namespace rigmap
