// A world laid on the Earth by satellite fixes, and how far that is to be believed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/options.h"
#include "georeference/earth_frame.h"
#include "georeference/rtk_alignment.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in earth_fit.cc.
struct EarthFitOptions {
  static constexpr const char* kSection = "georeference";

  double max_map_sigma_m = 1.0;

  OptionFields Fields();
};

// What the heights of the fixes say of the world's up in one direction: positive where the fixes
// rise more than the path. Radians.
struct TiltCheck {
  double angle_rad = 0.0;
  double sigma_rad = 0.0;
};

struct EarthFit {
  std::optional<EarthFrame> frame;
  std::string why;  // there is none: a sentence
  // The rest only where there is a frame.
  std::optional<RtkAlignment> horizontal;
  int heights = 0;              // fixes that gave the height
  double height_sigma_m = 0.0;  // of the world's height, one sigma
  double height_rms_m = 0.0;    // of these fixes about the path, of the fit, no score
  double edge_sigma_m = 0.0;    // horizontal, where the map is known least: one sigma per axis
  double heading_sigma_rad = 0.0;
  // Of the path's own directions, where its fixes tell anything of it: positive where fixes rise
  // more than the path, ahead and to the left of the way from its first fix to its last.
  std::optional<TiltCheck> along_path, across_path;
  std::vector<std::string> weaknesses;  // sentences
};

// Turned about the world's z and moved, horizontally as AlignToRtk does, in height by the mean of
// the fixes; the world's z stays up, and what the fixes say against it is told. Where the fixes
// leave the edge of the map less certain than AlignToRtk accepts, they are taken with the clock
// held as exact, up to options.max_map_sigma_m. No frame where they fit only with latitude and
// longitude exchanged. Throws UsageError for options out of range.
EarthFit FitToEarth(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                    const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& alignment,
                    const EarthFitOptions& options = {});

// What georeference.json says (docs/outputs.md). No dates, no paths.
nlohmann::ordered_json ToJson(const EarthFit& fit);

}  // namespace rigmap
