// Does one stage.
#pragma once

#include <any>
#include <string>
#include <vector>

#include "pipeline/internal/stage_files.h"
#include "pipeline/stage_graph.h"

namespace rigmap {

struct MadeStage {
  std::any product;
  std::vector<std::string> published;
  double seconds = 0.0;
  double peak_rss_mb = 0.0;  // of this process, or of its largest child if that grew meanwhile
};

// Makes, publishes and keeps, in this order. Throws what the stage throws; nothing of it is left
// then.
MadeStage MakeStage(const StageNode& stage, const std::string& key, StageContext context,
                    const StageNode::Inputs& inputs, const StageFiles& files);

}  // namespace rigmap
