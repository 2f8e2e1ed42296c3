// The stage `rtk`: poses tied to satellite fixes, where that was asked for.
#pragma once

#include <string>
#include <vector>

#include "georeference/rtk_alignment.h"
#include "pipeline/stage.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/fix_stretches.h"
#include "workflows/stages/joined_parts.h"

namespace rigmap {

struct TiedPart {
  AdjustedPart part;   // as it came, where the fixes are not to be used
  std::string report;  // JSON: what became of the fixes

  template <class Archive>
  void serialize(Archive& archive) {
    archive(part, report);
  }
};

// What --use-rtk needs of the rig file at `rig_source` and of the data. Throws DataError where the
// file does not state the antenna's position or there are no fixes.
void RequireFixes(const std::string& rig_source, bool has_antenna, std::size_t fixes);

using RtkStage = Stage<TiedPart, Takes<Dataset, AdjustedPart, JoinedParts, SplitFixes>,
                       Reads<RtkAlignmentOptions>>;
// Throws DataError where the rig does not know the antenna or there are no fixes. Publishes what
// the adjustment publishes of poses and points.
RtkStage TieToFixes();

// A view.
AdjustedPart PartOf(const StageContext& context, const TiedPart& tied);

}  // namespace rigmap
