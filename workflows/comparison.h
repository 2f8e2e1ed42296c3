// Results as rows of a comparison.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rigmap {

// What tells one run from the others.
struct RunName {
  std::string part, technique;
  std::string setting;  // "stage.option=value ...": how it differs from one with all defaults
  int repeat = 0;
  std::string run, truth;  // its folder, and the true trajectory if there is one: for pictures
};

using ComparisonRow = nlohmann::ordered_json;

// In the cell `judged_by` of a row whose ATE and scale are those of a prism's track; of true poses
// it is "poses".
inline constexpr const char* kPrismJudge = "prism, horizontal";

// From what `rigmap part` has left in `out`: summary.json, evaluation.json. Numbers that do not
// exist are null. Where the run could not be done, its exit code and the reason. Throws DataError
// where `out` holds no summary.
ComparisonRow MakeRow(const RunName& name, const std::filesystem::path& out);
// Of a run that ended before it left a summary.
ComparisonRow MakeFailedRow(const RunName& name, int exit_code, const std::string& reason);

// The names of all cells, in the order in which rows have them.
std::vector<std::string> ColumnsOf(const std::vector<ComparisonRow>& rows);
// {"rows": [...], "medians": [...]}: of the rows that are alike but for their repeat the median and
// the spread (largest less smallest) of each number.
nlohmann::ordered_json WriteComparison(const std::vector<ComparisonRow>& rows);
// A line per row, with a heading; empty cells for null.
std::string WriteComparisonCsv(const std::vector<ComparisonRow>& rows);
// A sentence for all settings of a technique by which none of a part's figures but times and memory
// differ.
std::vector<std::string> SettingsWithoutEffect(const std::vector<ComparisonRow>& rows);
// For people: the medians that matter most, "median +- half the spread" where runs differ.
std::string FormatComparison(const nlohmann::ordered_json& comparison);

}  // namespace rigmap
