// GeographicLib's own command line tools, to compare with.
#pragma once

#include <string>
#include <vector>

namespace rigmap {

// True if a program of this name is on PATH.
bool IsInstalled(const std::string& program);

// The numbers that a shell command prints; words that are no numbers are left out. Throws
// std::runtime_error unless it ends with 0.
std::vector<double> NumbersPrintedBy(const std::string& command);

}  // namespace rigmap
