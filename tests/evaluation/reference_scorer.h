// The scorers that were written apart from this project. They lie beside the test data and need
// Debian's numpy and scipy.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace rigmap {

inline constexpr const char* kPython = "/usr/bin/python3";  // Debian's: it has numpy and scipy

inline std::string OutputOf(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return output;
}

// Skips its tests, visibly, where data or scorers are missing.
class ReferenceScorerTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("RIGMAP_DATA");
    if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
    data_ = data;
    for (const char* name : {"trajectory_metrics.py", "map_metrics.py", "rock_fit.py"}) {
      if (!std::filesystem::exists(Scorer(name))) GTEST_SKIP() << Scorer(name) << " does not exist";
    }
    if (!std::filesystem::exists(kPython)) GTEST_SKIP() << kPython << " does not exist";
  }

  std::filesystem::path Scorer(const char* name) const { return data_ / ".." / "score" / name; }

  std::filesystem::path data_;
};

}  // namespace rigmap
