#include "mapping/internal/models_by_size.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace rigmap {

std::vector<SparseModel> NumberBySize(std::vector<MadeModel> made,
                                      const std::filesystem::path& models) {
  std::filesystem::create_directories(models);
  std::ranges::stable_sort(made, [](const MadeModel& a, const MadeModel& b) {
    return a.model.images.size() > b.model.images.size();
  });
  std::vector<SparseModel> numbered;
  for (MadeModel& each : made) {
    const auto folder = models / std::to_string(numbered.size());
    std::filesystem::rename(each.folder, folder);
    spdlog::info("model {}: {} images, {} points", folder.string(), each.model.images.size(),
                 each.model.points.size());
    numbered.push_back(std::move(each.model));
  }
  return numbered;
}

}  // namespace rigmap
