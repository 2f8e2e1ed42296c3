#include "workflows/mark_outputs.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "export/header_note.h"
#include "workflows/part_summary.h"

namespace rigmap {

void MarkOutputs(const std::filesystem::path& root, const Ledger& ledger) {
  constexpr std::array<std::string_view, 3> kWithComments{".tum", ".ply", ".yaml"};
  const PartResult result = Judge(ledger);
  if (result.status == PartStatus::kPartial) return;
  const std::string warning = WarningOf(result.refusal);
  for (const StageRecord& record : ledger.stages) {
    for (const std::string& name : record.published) {
      const std::filesystem::path path = root / name;
      if (std::ranges::find(kWithComments, path.extension()) == kWithComments.end()) continue;
      if (std::filesystem::exists(path)) SetHeaderNote(path, warning);
    }
  }
}

}  // namespace rigmap
