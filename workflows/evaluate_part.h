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

// With a truth, compares as the run's own config.yaml says, if it is there. One line of JSON, or a
// table for people. Throws DataError where there is nothing to compare.
std::string EvaluatePart(const EvaluateRequest& request);

}  // namespace rigmap
