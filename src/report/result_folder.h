// What lies in the folder of a part, a traverse or a comparison, as far as a report tells of it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "report/figures.h"
#include "scene/sparse_model.h"
#include "scene/trajectory.h"

namespace rigmap {

enum class ResultKind { kPart, kTraverse, kComparison };

struct PartOfTraverse {
  std::string name;
  Json summary, evaluation;  // null where there is none
};

struct ResultFolder {
  std::filesystem::path root;
  ResultKind kind = ResultKind::kPart;
  std::string name;  // of the folder, for people
  // Null where there is none: of a comparison all but `comparison`.
  Json summary, evaluation, reference, georeference, comparison;
  Trajectory trajectory;  // without position covariances; empty where there is none
  std::optional<SparseModel> sparse;
  std::vector<PartOfTraverse> parts;                // of a traverse
  std::map<StampNs, std::filesystem::path> images;  // left ones, those that are still there

  FigureSource Summary() const { return {"summary", summary}; }
  FigureSource Evaluation() const { return {"evaluation", evaluation}; }
};

// Throws DataError, one sentence each, where there is no such folder; where it holds no results,
// those of a run that is at work or was killed, or a summary of another kind than this release's.
// What else is missing or damaged is left out.
ResultFolder ReadResultFolder(const std::filesystem::path& root);

// Throws what ReadResultFolder would, without reading more than the summary.
void RequireResult(const std::filesystem::path& root);

// trajectory.csv as export/trajectory_csv.h writes it. Throws DataError naming file and line.
Trajectory ReadTrajectoryCsv(const std::filesystem::path& path);

// Distance driven from the first pose to each, metres.
std::vector<double> DistancesAlong(const Trajectory& trajectory);

}  // namespace rigmap
