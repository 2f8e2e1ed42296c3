// The stage `georeference`: leaves the route on the Earth where there are satellite fixes.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "evaluation/rock_segmentation.h"
#include "georeference/earth_fit.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/inputs.h"

namespace rigmap {

// Where the world lies on Earth, and the files that say so; empty texts where there are none.
struct Georeferenced {
  std::optional<EarthFrame> frame;
  std::string json, utm_csv, geojson, kml;

  // The grid that rasters and clouds are laid on.
  std::optional<GridFrame> Grid() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frame, json, utm_csv, geojson, kml);
  }
};

// Of any trajectory with its map, a part's or a traverse's. Kept by reference.
struct GeoreferenceInputs {
  std::span<const GnssFix> fixes;
  const Trajectory& trajectory;
  std::optional<Eigen::Vector3d> antenna_in_left;
  std::filesystem::path map_ply;  // for rocks; empty: no map
  WorldUp world_up = WorldUp::kCamera;
  std::string warning;  // what everything made of it has to bear; empty: nothing
};

// Nothing at all where there are no fixes, only `json` where they do not lay the world on the
// Earth.
Georeferenced GeoreferenceOf(const GeoreferenceInputs& inputs, const RtkAlignmentOptions& alignment,
                             const EarthFitOptions& earth, const RockSegmentationOptions& rocks);

// georeference.json, and where there is a frame trajectory_utm.csv, route.geojson and route.kml.
inline const std::vector<std::string> kGeoreferenceOutputs{
    "georeference.json", "trajectory_utm.csv", "route.geojson", "route.kml"};
void PublishGeoreferenced(Publication& publication, const Georeferenced& georeferenced);

using EarthStage = Stage<Georeferenced, Takes<Dataset, Fixes, PosedPart, FusedMap, Warning>,
                         Reads<RtkAlignmentOptions, EarthFitOptions, RockSegmentationOptions>>;
EarthStage GeoreferenceStage();

}  // namespace rigmap
