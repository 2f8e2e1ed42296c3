// The stage `depth_maps`: leaves the map's frames' depth as images, if asked for.
#pragma once

#include "imaging/depth_map_options.h"
#include "pipeline/stage.h"
#include "workflows/stages/dense.h"

namespace rigmap {

struct AskedForDepthMaps {
  bool asked = false;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(asked);
  }
};

using DepthMapsStage =
    Stage<AskedForDepthMaps, Takes<Dataset, PosedPart, DepthIndex>, Reads<DepthMapOptions>>;
DepthMapsStage DepthMaps();

}  // namespace rigmap
