// All options of `rigmap part`: one section per stage, as in config/default.yaml.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "colmap/installation.h"
#include "dead_reckoning/dead_reckoning_options.h"
#include "dense/dense_options.h"
#include "evaluation/rock_segmentation.h"
#include "evaluation/rock_survey.h"
#include "evaluation/trajectory_metrics.h"
#include "export/las_options.h"
#include "features/corner_tracker.h"
#include "features/feature_options.h"
#include "fusion/fusion_options.h"
#include "gates/gates.h"
#include "georeference/earth_fit.h"
#include "georeference/rtk_alignment.h"
#include "imaging/depth_map_options.h"
#include "imaging/mask.h"
#include "mapping/free_cameras.h"
#include "mapping/mapping_options.h"
#include "matching/matching_options.h"
#include "odometry/odometry_options.h"
#include "raster/raster_options.h"
#include "registration/registration_options.h"
#include "scale/scale_options.h"
#include "scene/voxel_options.h"

namespace rigmap {

struct PartOptions {
  MaskOptions masks;
  FeatureOptions features;
  CornerOptions corners;  // in the section klt
  OdometryOptions odometry;
  DeadReckoningOptions dead_reckoning;
  FilterOptions filter;
  MatchingOptions matching;
  ColmapOptions colmap;
  MappingOptions mapping;
  KeyframeGraphOptions keyframe_graph;  // in the section of mapping
  ScaleOptions scale;
  FreeMatchingOptions free_matching;  // in the section sfm, both
  FreeMappingOptions free_mapping;
  AdjustmentOptions adjustment;
  CloudOptions clouds;  // in the section of registration
  RegistrationOptions registration;
  MergeOptions merging;  // in the section of registration
  DenseOptions dense;
  DepthMapOptions depth_maps;  // in the section of dense
  VoxelOptions voxel;          // in the section of fusion
  FusionOptions fusion;
  RasterOptions raster;
  FootprintOptions terrain;  // in the section of raster, as the next
  PictureOptions pictures;   // in the section of raster
  EvaluationOptions evaluation;
  RtkAlignmentOptions georeference;
  EarthFitOptions earth;  // in the section of georeference, as the next
  LasOptions las;
  RockSegmentationOptions rocks;
  RockSurveyOptions rock_survey;  // in the section of rocks
  GateOptions gates;

  // In the order of the file.
  std::vector<OptionSection> Sections();
  void Validate() const;  // throws UsageError
};

// The defaults, then the file, then each "stage.option=value". Throws DataError for the file,
// UsageError for the rest.
PartOptions LoadPartOptions(const std::optional<std::filesystem::path>& config,
                            const std::vector<std::string>& assignments);

// "stage.option=value" of each option that differs from its default or is among `named`
// ("stage.option"), in the order of the file.
std::vector<std::string> ListChangedOptions(PartOptions options,
                                            const std::vector<std::string>& named = {});

// YAML that LoadPartOptions reads back to the same options.
std::string WritePartOptions(PartOptions options);

}  // namespace rigmap
