// What a part's recipe is given from outside.
#pragma once

#include <optional>
#include <vector>

#include "colmap/installation.h"
#include "dataset/dataset_content.h"
#include "pipeline/stage_graph.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {

// What lays finished products on the Earth. No stage that makes a pose or a point takes it.
struct Fixes {
  std::vector<GnssFix> fixes;
};

struct PartInputs {
  Node<Dataset> dataset;
  Node<DatasetContent> content;  // of the dataset, for the keys of single frames
  Node<Truth> truth;
  Node<Fixes> fixes;
  Node<ColmapInstallation> colmap;  // looked for on PATH when a stage needs it
};

// Of the data set's fixes only the judges, where given, are truth; all of them lay products on the
// Earth.
PartInputs AddPartInputs(StageGraph& graph, const Dataset& dataset, const DatasetContent& content,
                         const ColmapOptions& colmap,
                         const std::optional<std::vector<GnssFix>>& judges = std::nullopt);

}  // namespace rigmap
