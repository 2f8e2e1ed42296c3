// The true surface as a file, to judge maps by.
#pragma once

#include <cstdint>
#include <filesystem>

#include "simulation/internal/surface_samples.h"
#include "simulation/internal/surface_visibility.h"

namespace rigmap {

struct TruthSurfaceSummary {
  std::uint64_t points = 0, visible = 0;
};

// Writes a binary little-endian PLY, 17 bytes a point:
//   float x y z          local east north up, metres
//   char nx ny nz        the unit normal times 127
//   uchar visible        1 or 0, see SurfaceVisibility
//   uchar kind           0 sand, 2 rock, 3 debris, see SurfaceKind
// in the sampler's order, whatever the number of threads (TBB's); memory does not grow with the
// file. Throws DataError when the file cannot be written.
TruthSurfaceSummary WriteTruthSurface(const std::filesystem::path& file,
                                      const SurfaceSampler& sampler,
                                      const SurfaceVisibility& visibility);

}  // namespace rigmap
