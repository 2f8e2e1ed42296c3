// The runs that a comparison is made of.
#pragma once

#include <filesystem>
#include <vector>

#include "workflows/compare.h"
#include "workflows/comparison.h"

namespace rigmap {

struct ComparisonRun {
  RunName name;
  PartRequest request;

  const std::filesystem::path& Out() const { return request.out; }
  // The row, kept beside the folder.
  std::filesystem::path RowFile() const { return Out().string() + ".json"; }
};

// Of all parts that the request names, by each technique, with each setting, as often as chance has
// a say. Throws UsageError and DataError where options or folders are wrong.
std::vector<ComparisonRun> PlanComparison(const CompareRequest& request);

// What else lies in a folder is not ours. Nothing where there is no such folder.
std::vector<std::filesystem::path> FoldersIn(const std::filesystem::path& folder);

}  // namespace rigmap
