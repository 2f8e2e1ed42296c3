#include "workflows/stages/inputs.h"

#include <memory>

namespace rigmap {
namespace {

Report ReportDataset(const Dataset& dataset) {
  const DatasetHealth& health = dataset.health;
  return {{"frames", {{"read", health.images_read}, {"paired", dataset.frames.size()}}},
          {"health",
           {{"lone_images", health.lone_images},
            {"unreadable_images", health.unreadable_images},
            {"remarks", health.remarks}}}};
}

}  // namespace

PartInputs AddPartInputs(StageGraph& graph, const Dataset& dataset, const DatasetContent& content,
                         const ColmapOptions& colmap_options,
                         const std::optional<std::vector<GnssFix>>& judges) {
  // Its sensors are a hundred times as many as its frames: one copy for all.
  const auto shared = std::make_shared<const Dataset>(dataset);
  const auto open_dataset = [shared, content] { return std::pair(content.Key(), *shared); };
  const auto open_content = [content] { return std::pair(content.Key(), content); };
  const auto open_truth = [shared, judges] {
    Truth truth{shared->truth_path, judges.value_or(shared->fixes), shared->surveyed_landmarks};
    std::string key = DescribeTruth(truth);
    return std::pair(std::move(key), std::move(truth));
  };
  const auto open_fixes = [shared] {
    return std::pair(DescribeTruth({"", shared->fixes, {}}), Fixes{shared->fixes});
  };
  // The version is the key: how long one waits for it changes nothing.
  const auto open_colmap = [colmap_options] {
    ColmapInstallation colmap = FindColmap();
    colmap.patience_s = colmap_options.patience_s;
    return std::pair(colmap.version_text, colmap);
  };
  return {graph.AddSource<Dataset>("dataset", open_dataset, ReportDataset),
          graph.AddSource<DatasetContent>("content", open_content),
          graph.AddSource<Truth>("truth", open_truth), graph.AddSource<Fixes>("fixes", open_fixes),
          graph.AddSource<ColmapInstallation>("colmap", open_colmap)};
}

}  // namespace rigmap
