// The parts of a drive as one data set.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scene/dataset.h"
#include "workflows/output_folder.h"
#include "workflows/part_folder.h"
#include "workflows/stages/joined_parts.h"

namespace rigmap {

struct UnionOfParts {
  Dataset dataset;  // all frames once, in order of time; the rig that the parts were given
  JoinedParts parts;
  KnownDepths depths;
  std::vector<std::string> contents;  // DatasetContent::frames of its frames

  FolderMark Mark() const;
};

// File names in it are relative to `out`. Its rig is that of the file that all were given, with the
// file's pool, or else the one that they began with before any pool. Throws DataError where a
// folder holds no part that can be joined or no longer its keypoints, where the parts were given
// different rigs or features made with different options, and where they disagree about a frame
// that they share.
UnionOfParts UniteParts(const std::vector<PartFolder>& folders, const std::filesystem::path& out);

// Adds a part's record of a sensor to those of the parts before. One that cannot be used is no harm
// to the others: what it lacks is a gap.
template <class Record>
void AppendRecord(const Record& from, Record& to) {
  if (!from.problem.empty()) {
    if (to.samples.empty()) to.problem = from.problem;
    return;
  }
  to.samples.insert(to.samples.end(), from.samples.begin(), from.samples.end());
  if (!to.samples.empty()) to.problem.clear();
}

// Of parts' names and remarks: what all of them remark once, anything else with the part.
std::vector<std::string> RemarksOfParts(
    const std::vector<std::pair<std::string, std::vector<std::string>>>& parts);

}  // namespace rigmap
