#include "raster/raster_options.h"

namespace rigmap {

void RasterOptions::Validate() const {
  RequireOption(max_hole_cells >= 0 && max_hole_cells <= 100, "raster.max_hole_cells", "0 to 100",
                max_hole_cells);
}

void PictureOptions::Validate() const {
  RequireOption(picture_px >= 1000 && picture_px <= 4096, "raster.picture_px", "1000 to 4096",
                picture_px);
}

}  // namespace rigmap
