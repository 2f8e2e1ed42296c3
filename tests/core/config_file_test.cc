#include "core/config_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// The test program lies in the build tree, which has a link to the sources' config.
TEST(ConfigFile, IsFoundAboveTheProgramWhateverTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path("/");
  const fs::path found = ConfigFile("default.yaml");
  fs::current_path(before);
  EXPECT_TRUE(found.is_absolute());
  EXPECT_TRUE(fs::is_regular_file(found)) << found;
}

TEST(ConfigFile, OfAnUnknownNameIsRelative) {
  EXPECT_EQ(ConfigFile("no-such-file.yaml"), fs::path("config/no-such-file.yaml"));
}

}  // namespace
}  // namespace rigmap
