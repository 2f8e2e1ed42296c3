// What the program says of itself.
#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// What bash offers after `words`, the last of which is begun only.
std::string Completed(const std::string& words) {
  const TemporaryFolder folder;
  const auto script =
      folder.Write("complete.sh", RunRigmap({"completion"}).out + "\nCOMP_WORDS=(" + words +
                                      ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                                      "_rigmap\necho \"${COMPREPLY[@]}\"\n");
  const ProgramEnd end = RunProgram("bash", {script});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  return end.out;
}

TEST(CommandDocuments, CompletionKnowsCommandsAndArguments) {
  EXPECT_EQ(Completed("rigmap rep"), "report\n");
  EXPECT_EQ(Completed("rigmap part --dat"), "--dataset\n");
  EXPECT_EQ(Completed("rigmap part --technique wh"), "wheels\n");
  EXPECT_THAT(Completed("rigmap calibrate --r"), HasSubstr("--rig-out"));
}

TEST(CommandDocuments, TheManualTellsOfEveryCommand) {
  const ProgramEnd end = RunRigmap({"manual"});
  EXPECT_EQ(end.exit_code, 0);
  EXPECT_THAT(end.out, StartsWith(".TH RIGMAP 1\n"));
  for (const char* command :
       {"part", "evaluate", "calibrate", "compare", "report", "options", "stages", "manual"}) {
    EXPECT_THAT(end.out, HasSubstr(std::string(".SS rigmap ") + command + "\n"));
  }
  EXPECT_THAT(end.out, AllOf(HasSubstr(".B \\-\\-dataset"), HasSubstr("EXIT STATUS")));
}

TEST(CommandDocuments, HelpHasExamples) {
  for (const char* command : {"part", "evaluate", "calibrate", "compare", "report"}) {
    const ProgramEnd end = RunRigmap({command, "--help"});
    EXPECT_EQ(end.exit_code, 0);
    EXPECT_THAT(end.out,
                AllOf(HasSubstr("Examples:\n"), HasSubstr("rigmap " + std::string(command))));
    const std::size_t options = end.out.find("Options for --set");
    if (options != std::string::npos) {
      EXPECT_EQ(end.out.find("Options for --set", options + 1), std::string::npos) << command;
    }
  }
}

}  // namespace
}  // namespace rigmap
