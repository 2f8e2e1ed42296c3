// The height of the sand at every place: a pure function, so that geometry, wheels and truth agree.
#pragma once

#include <cstdint>
#include <memory>

namespace rigmap {

struct TerrainOptions {
  double undulation_m = 0.16;     // amplitude of hollows and banks metres long
  double ripple_m = 0.0055;       // amplitude of wind ripples, about a decimetre long
  double roughness_m = 0.032;     // amplitude of lumps, 4 to 60 cm wide
  double footprint_trails = 1.5;  // trails of 12 m per 100 m2
  double tyre_tracks = 0.3;       // pairs of ruts, 25 m long, per 100 m2
  double hinterland_m = 110.0;    // how far to the east and west the beach is one
  std::uint64_t seed = 1;
};

// Footprints and ruts lie within kTrodden_m of the origin; beyond the hinterland to the east rise
// dunes, and as far to the west the beach falls below the sea, which stands at kSeaLevel_m.
class Terrain {
 public:
  static constexpr double kTrodden_m = 120.0, kSeaLevel_m = -1.0;

  explicit Terrain(const TerrainOptions& options);
  ~Terrain();
  Terrain(Terrain&&) noexcept;

  // Metres above the local origin's tangent plane; mean about zero. Thread-safe, half a
  // microsecond.
  double Height(double east_m, double north_m) const { return Height(east_m, north_m, 0.0); }
  // As a mesh with cells of `cell_m` should sample it: without what is shorter than four cells.
  double Height(double east_m, double north_m, double cell_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigmap
