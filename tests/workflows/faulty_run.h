// Runs of a part in which something goes wrong.
#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {

namespace fs = std::filesystem;

class FaultTest : public testing::Test {
 protected:
  std::vector<std::string> Arguments(const fs::path& out,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"part", "--dataset", data_, "--out", out, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void Succeeds(const fs::path& out, const std::vector<std::string>& more = {}) const {
    const ProgramEnd end = RunRigmap(Arguments(out, more));
    EXPECT_EQ(end.exit_code, 0) << end.err;
  }
  // The last line of standard error of a run that ends with 1; nothing half-written may be left.
  static std::string LastWord(const ProgramEnd& end, const fs::path& out) {
    EXPECT_EQ(end.exit_code, 1) << end.err;
    EXPECT_THAT(end.LastErrorLine(), testing::StartsWith("rigmap: "));
    if (fs::exists(out)) ExpectNothingUnfinished(out);
    return end.LastErrorLine();
  }
  std::string Fails(const fs::path& out, const std::vector<std::string>& more = {}) const {
    return LastWord(RunRigmap(Arguments(out, more)), out);
  }
  static void ExpectNothingUnfinished(const fs::path& out) {
    for (const std::string& name : FilesIn(out)) EXPECT_FALSE(IsTemporaryName(name)) << name;
  }
  static std::string ResultOf(const fs::path& out) {
    return ReadTextFile(out / "trajectory.tum") + ReadTextFile(out / "sparse.ply") +
           ReadTextFile(out / "dense.ply");
  }
  static nlohmann::json SummaryOf(const fs::path& out) {
    return nlohmann::json::parse(ReadTextFile(out / "summary.json"));
  }

  TemporaryFolder folder_;
  fs::path data_ = SimulatedPartFolder();
  fs::path out_ = folder_.Path() / "out", undisturbed_ = folder_.Path() / "undisturbed";
};

}  // namespace rigmap
