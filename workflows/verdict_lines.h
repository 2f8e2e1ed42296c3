// The end of `rigmap part` for people: the report's first screen as lines.
#pragma once

#include <filesystem>
#include <string>

namespace rigmap {

// Four lines at most, each with "rigmap: " in front: what the figures are worth, path and
// positions, frames, time and memory, where the report is. From the folder's summary.json; what it
// does not tell is left out. Empty where it cannot be read.
std::string VerdictLines(const std::filesystem::path& out);

}  // namespace rigmap
