// Small files made by tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace rigmap {

// Writes `bytes` and returns the path, so that a reader can be called on it at once.
inline std::filesystem::path WriteTestFile(const std::filesystem::path& path,
                                           const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

}  // namespace rigmap
