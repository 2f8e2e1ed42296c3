#include "workflows/mark_outputs.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "export/header_note.h"
#include "workflows/part_summary.h"

namespace rigmap {

namespace {

namespace fs = std::filesystem;

// The file, or those of the folder.
std::vector<fs::path> FilesOf(const fs::path& published) {
  std::vector<fs::path> files;
  if (!fs::is_directory(published)) {
    if (fs::exists(published)) files.push_back(published);
    return files;
  }
  for (const auto& entry : fs::recursive_directory_iterator(published)) {
    if (entry.is_regular_file() && !entry.is_symlink()) files.push_back(entry.path());
  }
  return files;
}

}  // namespace

void MarkOutputs(const fs::path& root, const Ledger& ledger) {
  constexpr std::array<std::string_view, 4> kWithComments{".g2o", ".tum", ".ply", ".yaml"};
  const PartResult result = Judge(ledger);
  if (result.status == PartStatus::kPartial) return;
  const std::string warning = WarningOf(result.refusal);
  for (const StageRecord& record : ledger.stages) {
    for (const std::string& name : record.published) {
      for (const fs::path& path : FilesOf(root / name)) {
        const std::string extension = path.extension();
        // Other text files have no comments; evo takes them in this one, too.
        const bool is_kitti = path.filename() == "trajectory_kitti.txt";
        if (is_kitti || std::ranges::count(kWithComments, extension)) SetHeaderNote(path, warning);
      }
    }
  }
}

}  // namespace rigmap
