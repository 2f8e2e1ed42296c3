// The folders of parts, told apart.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigmap {

// A part's folder and what it is called, fit for a file's name.
struct PartFolder {
  std::filesystem::path root;  // absolute
  std::string name;
};

// By the last of their folders' names, or as many more of them as make all names different. Throws
// UsageError where there is none or a folder is given twice.
std::vector<PartFolder> NameParts(const std::vector<std::filesystem::path>& outs);

}  // namespace rigmap
