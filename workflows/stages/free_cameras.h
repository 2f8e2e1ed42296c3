// The stages of structure from motion with free cameras: `database`, `mapping`, `scale` and
// `trajectory` of the techniques sfm and combined.
#pragma once

#include "colmap/installation.h"
#include "dataset/dataset_content.h"
#include "mapping/free_cameras.h"
#include "pipeline/stage.h"
#include "scale/scale_options.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

// What is kept of the database beside the database itself.
struct FreeMatches {
  std::size_t image_pairs = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(image_pairs);
  }
};

// Takes the images' content as well, since COLMAP reads them itself.
using FreeMatchingStage = Stage<FreeMatches, Takes<ColmapInstallation, Dataset, DatasetContent>,
                                Reads<FreeMatchingOptions>>;
FreeMatchingStage FreeMatching();

using FreeMappingStage = Stage<MappingResult, Takes<ColmapInstallation, Dataset, FreeMatches>,
                               Reads<FreeMappingOptions>>;
FreeMappingStage FreeMapping();

using FreeScaleStage = Stage<AlignedKeyframes, Takes<Dataset, MappingResult>, Reads<ScaleOptions>>;
FreeScaleStage FreeScale();

using FreeTrajectoryStage =
    Stage<AdjustedPart, Takes<Dataset, MappingResult, AlignedKeyframes>, Reads<>>;
FreeTrajectoryStage FreeTrajectory();

}  // namespace rigmap
