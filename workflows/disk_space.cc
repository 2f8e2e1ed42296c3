#include "workflows/disk_space.h"

#include <fmt/format.h>

#include "core/error.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

double FolderMegabytes(const fs::path& folder) {
  double bytes = 0.0;
  std::error_code ignored;  // files of a run that is at work may vanish
  for (auto file = fs::recursive_directory_iterator(folder, ignored);
       !ignored && file != fs::recursive_directory_iterator(); file.increment(ignored)) {
    if (file->is_symlink(ignored)) continue;  // to images, which are the data's own
    if (file->is_regular_file(ignored)) bytes += static_cast<double>(file->file_size(ignored));
  }
  return 1e-6 * bytes;
}

fs::path NearestThatExists(fs::path path) {
  path = fs::absolute(path);
  while (!fs::exists(path) && path.has_relative_path()) path = path.parent_path();
  return path;
}

}  // namespace

void RequireDisk(const TraversePlan& plan, const fs::path& out) {
  const double needed_mb = EstimatedDiskMegabytes(plan) - FolderMegabytes(out);
  const double free_mb = 1e-6 * static_cast<double>(fs::space(NearestThatExists(out)).available);
  if (needed_mb <= free_mb) return;
  throw DataError(
      fmt::format("{}: expected {:.0f} MB free on its disk, about as much as {} pairs "
                  "will leave, found {:.0f} MB",
                  out.string(), needed_mb, PairsOf(plan), free_mb));
}

}  // namespace rigmap
