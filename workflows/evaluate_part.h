// `rigmap evaluate`: a finished result against a truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace rigmap {

struct EvaluateRequest {
  std::filesystem::path out;                   // holds trajectory.tum
  std::optional<std::filesystem::path> truth;  // nothing: evaluation.json as the run left it
  bool json = false;
};

// The file that a --truth names: itself, or in a folder trajectory.tum, groundtruth_tum.txt or
// groundtruth_xy.txt, a prism's track. Throws DataError if the folder holds none.
std::filesystem::path TruthFile(const std::filesystem::path& truth);

// The same for a traverse: a file, or a folder with trajectory.tum or one for each of its parts.
std::filesystem::path WholeTruth(const std::filesystem::path& truth);

// With a truth, compares as the run's own config.yaml says, if it is there. One line of JSON, or a
// table for people. Throws DataError where there is nothing to compare.
std::string EvaluatePart(const EvaluateRequest& request);

}  // namespace rigmap
