// How true and how complete a map is.
#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "evaluation/map_over_truth.h"

namespace rigmap {

// m, from the true path: the wheels' surroundings, what a metre-wide rover may pass, all that a low
// stereo rig with a short baseline sees to a centimetre or two, and to five.
inline constexpr std::array<double, 4> kMapBands_m{1.5, 2.5, 3.5, 6.0};
// m; a grain of the map, two, and what a wheel does not mind.
inline constexpr std::array<double, 3> kMapTolerances_m{0.01, 0.02, 0.05};

// Precision and completeness at one tolerance (Knapitsch et al. 2017, eq. 1 to 4).
struct MapShares {
  double precision = 0.0;     // of the map's points: as near to the surface
  double completeness = 0.0;  // of the visible surface points: a map point as near

  double HarmonicMean() const;  // 0 where both are
};

struct BandMetrics {
  std::size_t points = 0;          // of the map
  double accuracy_median_m = 0.0;  // distance of map points from the surface
  double accuracy_p90_m = 0.0;
  double stray_share = 0.0;  // of map points: over 20 cm from the surface
  // Of map points: from the surface by at most one, two, three of their sigmas. Nothing for a map
  // that states none.
  std::optional<std::array<double, 3>> within_sigmas;
  std::array<MapShares, kMapTolerances_m.size()> at_tolerance;
};

struct MapMetrics {
  std::size_t map_points = 0, truth_points = 0, visible_points = 0;
  // So many bands, from the first on: all but the widest, and this where the true surface fills it.
  std::size_t judged = 0;
  // Nothing for a band beyond these, without a map point or without a visible surface point.
  std::array<std::optional<BandMetrics>, kMapBands_m.size()> bands;
};

// A map point's distance from the surface is that from the tangent plane of the nearest surface
// point where this is within 2 cm, else that from the point itself, 1 m at most. Takes 32 bytes a
// map point besides `map`. Splits its work with TBB; the result does not depend on the threads.
MapMetrics CompareMap(const MapOverTruth& map);

// The keys of evaluation.json, rounded as printed: map_points, truth_points, visible_points and for
// each band that is judged within_<metres>m: null or points, accuracy_median_mm,
// accuracy_p90_mm, stray_over_20cm_pct and, for each tolerance, precision_<n>cm,
// completeness_<n>cm, f_<n>cm.
nlohmann::ordered_json ToJson(const MapMetrics& metrics);
// For each band that is judged within_<n>_sigma_pct; null for a map that states no sigmas.
nlohmann::ordered_json SigmasToJson(const MapMetrics& metrics);

}  // namespace rigmap
