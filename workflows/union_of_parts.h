// The parts of a drive as one data set.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/dataset.h"
#include "workflows/output_folder.h"
#include "workflows/stages/joined_parts.h"

namespace rigmap {

struct UnionOfParts {
  Dataset dataset;  // all frames once, in order of time; the rig that the parts were given
  JoinedParts parts;
  KnownDepths depths;
  std::vector<std::string> contents;  // DatasetContent::frames of its frames

  FolderMark Mark() const;
};

// What a part is called: the last of its folder's names.
std::string PartName(const std::filesystem::path& out);

// File names in it are relative to `out`. Throws DataError where a folder holds no part that can be
// joined, where the parts were given different rigs or features made with different options, and
// where they disagree about a frame that they share.
UnionOfParts UniteParts(const std::vector<std::filesystem::path>& outs,
                        const std::filesystem::path& out);

}  // namespace rigmap
