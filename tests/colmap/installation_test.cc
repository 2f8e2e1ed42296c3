#include "colmap/installation.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

// Puts a `colmap` of the test's own first on PATH.
class FakeColmap : public testing::Test {
 protected:
  void SetUp() override { path_before_ = std::getenv("PATH"); }
  void TearDown() override { setenv("PATH", path_before_.c_str(), 1); }

  void Install(const std::string& script) {
    const auto program = folder_.Path() / "colmap";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    setenv("PATH", (folder_.Path().string() + ":" + path_before_).c_str(), 1);
  }

  std::string Refusal(double patience_s = 10.0) {
    try {
      FindColmap(patience_s);
    } catch (const ToolError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  TemporaryFolder folder_;
  std::string path_before_;
};

TEST(FindColmap, FindsTheInstalledOne) {
  const ColmapInstallation colmap = FindColmap();
  EXPECT_THAT(colmap.path, HasSubstr("/colmap"));
  EXPECT_THAT(colmap.version_text, testing::StartsWith("3.8"));
}

TEST_F(FakeColmap, IsTakenAtRunTime) {
  Install("echo 'COLMAP 3.8 -- Structure-from-Motion and Multi-View Stereo'");
  EXPECT_EQ(FindColmap().path, (folder_.Path() / "colmap").string());
}

TEST_F(FakeColmap, OfAnotherVersionIsRefused) {
  for (const std::string version : {"3.7", "3.9.1", "3.80", "4.1.1", "3.13-dev"}) {
    Install("echo 'COLMAP " + version + " -- Structure-from-Motion and Multi-View Stereo'");
    const std::string message = Refusal();
    EXPECT_THAT(message, HasSubstr("found COLMAP " + version));
    EXPECT_THAT(message, HasSubstr("expected COLMAP 3.8"));
    EXPECT_THAT(message, HasSubstr(folder_.Path().string()));
  }
}

TEST_F(FakeColmap, ThatNamesNoVersionIsRefused) {
  Install("echo hello");
  EXPECT_THAT(Refusal(), HasSubstr("names no version (its last lines: hello)"));
}

TEST_F(FakeColmap, ThatCrashesIsRefused) {
  Install("echo libfoo is missing >&2; exit 127");
  EXPECT_THAT(Refusal(), HasSubstr("exit code 127 (its last lines: libfoo is missing)"));
}

TEST_F(FakeColmap, ThatHangsIsKilled) {
  Install("sleep 10");
  EXPECT_THAT(Refusal(0.3), HasSubstr("was killed after"));
}

TEST_F(FakeColmap, MissingIsSaidWithThePath) {
  setenv("PATH", folder_.Path().c_str(), 1);
  EXPECT_THAT(Refusal(), HasSubstr("not found on PATH (" + folder_.Path().string()));
}

}  // namespace
}  // namespace rigmap
