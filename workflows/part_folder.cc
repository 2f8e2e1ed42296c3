#include "workflows/part_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// "a-b" of the last two of /x/a/b.
std::string LastNames(const fs::path& root, std::size_t count) {
  const fs::path below = root.relative_path();
  const std::vector<fs::path> names(below.begin(), below.end());
  std::string text;
  for (std::size_t i = names.size() - std::min(count, names.size()); i < names.size(); ++i) {
    if (!text.empty()) text.push_back('-');
    text += names[i].string();
  }
  return text;
}

bool AreNamedApart(const std::vector<PartFolder>& folders) {
  std::set<std::string> names;
  for (const PartFolder& folder : folders) names.insert(folder.name);
  return names.size() == folders.size();
}

}  // namespace

std::vector<PartFolder> NameParts(const std::vector<fs::path>& outs) {
  if (outs.empty()) throw UsageError("join: expected folders with parts, found none");
  std::vector<PartFolder> folders;
  std::size_t longest = 0;
  for (const fs::path& out : outs) {
    fs::path root = fs::weakly_canonical(out);
    if (!root.has_filename()) root = root.parent_path();
    if (std::ranges::count(folders, root, &PartFolder::root) > 0) {
      throw UsageError(fmt::format("expected each folder once, found {} twice", out.string()));
    }
    longest = std::max<std::size_t>(longest, std::distance(root.begin(), root.end()));
    folders.push_back({std::move(root), ""});
  }
  for (std::size_t names = 1; names <= longest; ++names) {
    for (PartFolder& folder : folders) folder.name = LastNames(folder.root, names);
    if (AreNamedApart(folders)) return folders;
  }
  // a-b/1 beside a/b-1: by numbers as well.
  for (std::size_t i = 0; i < folders.size(); ++i) folders[i].name += fmt::format("-{}", i + 1);
  return folders;
}

}  // namespace rigmap
