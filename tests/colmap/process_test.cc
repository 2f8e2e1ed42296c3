#include "colmap/internal/process.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

ProcessRequest Shell(const std::string& script) {
  return {.program = "sh", .arguments = {"-c", script}};
}

bool Exists(pid_t process) {
  // A zombie still answers to kill: what counts is whether it runs.
  std::ifstream stream("/proc/" + std::to_string(process) + "/stat");
  std::string id, name, state;
  return stream >> id >> name >> state && state != "Z" && state != "X";
}

TEST(RunProcess, GivesExitCodeAndBothOutputsLineByLine) {
  std::vector<std::string> lines;
  ProcessRequest request = Shell("echo one; echo two >&2; printf three; exit 7");
  request.on_line = [&](const std::string& line) { lines.push_back(line); };
  const ProcessResult result = RunProcess(request);
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_EQ(result.signal, 0);
  EXPECT_FALSE(result.Succeeded());
  EXPECT_THAT(lines, ElementsAre("one", "two", "three"));
  EXPECT_GT(result.peak_rss_mb, 0.0);
}

TEST(RunProcess, GivesTheSignal) {
  const ProcessResult result = RunProcess(Shell("kill -ABRT $$"));
  EXPECT_EQ(result.signal, SIGABRT);
  EXPECT_FALSE(result.Succeeded());
}

TEST(RunProcess, AppendsCommandAndOutputToTheLog) {
  const TemporaryFolder folder;
  ProcessRequest request = Shell("echo first");
  request.log_path = folder.Path() / "logs" / "child.log";
  RunProcess(request);
  request.arguments = {"-c", "echo second"};
  RunProcess(request);
  EXPECT_EQ(ReadTextFile(request.log_path),
            "$ sh -c 'echo first'\nfirst\n$ sh -c 'echo second'\nsecond\n");
}

TEST(RunProcess, PassesArgumentsUnchanged) {
  std::vector<std::string> lines;
  ProcessRequest request{.program = "printf", .arguments = {"%s\\n", "a b", "", "$HOME", "'x'"}};
  request.on_line = [&](const std::string& line) { lines.push_back(line); };
  RunProcess(request);
  EXPECT_THAT(lines, ElementsAre("a b", "", "$HOME", "'x'"));
}

TEST(RunProcess, AddsToTheEnvironment) {
  setenv("RIGMAP_TEST_KEPT", "kept", 1);
  setenv("RIGMAP_TEST_CHANGED", "old", 1);
  ProcessRequest request = Shell("echo $RIGMAP_TEST_KEPT $RIGMAP_TEST_CHANGED");
  request.environment = {{"RIGMAP_TEST_CHANGED", "new"}};
  EXPECT_THAT(RunProcess(request).last_lines, ElementsAre("kept new"));
}

TEST(RunProcess, HasEmptyStandardInput) { EXPECT_TRUE(RunProcess(Shell("cat")).Succeeded()); }

TEST(RunProcess, PassesMuchOutput) {
  std::size_t lines = 0;
  ProcessRequest request = Shell("seq 200000");
  request.on_line = [&](const std::string&) { ++lines; };
  const ProcessResult result = RunProcess(request);
  EXPECT_EQ(lines, 200000u);
  EXPECT_EQ(result.last_lines.back(), "200000");
}

TEST(RunProcess, LeavesNoDescriptorOfOursToTheChild) {
  // What this test program had open from the start, any child inherits.
  std::string expected, found;
  FILE* list = popen("ls /proc/self/fd", "r");
  for (int c = fgetc(list); c != EOF; c = fgetc(list)) expected += static_cast<char>(c);
  pclose(list);
  const TemporaryFolder folder;
  ProcessRequest request{.program = "ls", .arguments = {"/proc/self/fd"}};
  request.log_path = folder.Path() / "log";
  request.on_line = [&](const std::string& line) { found += line + "\n"; };
  RunProcess(request);
  EXPECT_EQ(found, expected);
}

TEST(RunProcess, KillsASilentChildThoughAGrandchildHoldsThePipe) {
  ProcessRequest request = Shell("echo begun; sleep 5; echo never");
  request.timeout_without_output_s = 0.3;
  const ProcessResult result = RunProcess(request);
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.signal, SIGKILL);
  EXPECT_LT(result.seconds, 3.0);
  EXPECT_THAT(result.last_lines, ElementsAre("begun"));
}

TEST(RunProcess, KillsATalkativeChildAtItsTotalTimeout) {
  ProcessRequest request = Shell("while :; do echo on; sleep 0.05; done");
  request.timeout_without_output_s = 2.0;
  request.timeout_s = 0.4;
  const ProcessResult result = RunProcess(request);
  EXPECT_TRUE(result.timed_out);
  EXPECT_LT(result.seconds, 2.0);
}

TEST(RunProcess, KillsAChildThatClosedItsOutput) {
  ProcessRequest request = Shell("exec >&- 2>&-; exec sleep 5");
  request.timeout_s = 0.3;
  EXPECT_LT(RunProcess(request).seconds, 3.0);
}

TEST(RunProcess, KillsTheChildWhenTheCallerThrows) {
  pid_t child = 0;
  ProcessRequest request = Shell("echo $$; exec sleep 5");
  request.on_line = [&](const std::string& line) {
    child = std::stoi(line);
    throw DataError("enough");
  };
  EXPECT_THROW(RunProcess(request), DataError);
  ASSERT_GT(child, 0);
  EXPECT_FALSE(Exists(child));
}

bool WaitUntil(const std::function<bool()>& holds) {
  for (int i = 0; i < 200 && !holds(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  return holds();
}

// Shell commands that write the shell's id to a file, whole or not at all.
std::string NoteId(const std::filesystem::path& file) {
  return "echo $$ > " + file.string() + ".new; mv " + file.string() + ".new " + file.string() +
         "; ";
}

TEST(RunProcess, ChildDiesWithItsParent) {
  const TemporaryFolder folder;
  const auto note = folder.Path() / "child";
  const pid_t parent = fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    RunProcess(Shell(NoteId(note) + "exec sleep 30"));
    _exit(0);
  }
  ASSERT_TRUE(WaitUntil([&] { return std::filesystem::exists(note); }));
  const pid_t child = std::stoi(ReadTextFile(note));
  EXPECT_TRUE(Exists(child));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_TRUE(WaitUntil([&] { return !Exists(child); }));
}

// The program may be a script that starts the real one as a child of its own.
class Wrapper : public testing::Test {
 protected:
  ProcessRequest Request(const std::string& end) const {
    const auto real = folder_.Write("real", "#!/bin/sh\n" + NoteId(note_) + "exec sleep 30\n");
    std::filesystem::permissions(real, std::filesystem::perms::owner_all);
    return Shell(real.string() + " & " + end);
  }
  pid_t Grandchild() const {
    EXPECT_TRUE(WaitUntil([&] { return std::filesystem::exists(note_); }));
    return std::stoi(ReadTextFile(note_));
  }
  void ExpectGrandchildDied() const {
    const pid_t grandchild = Grandchild();
    EXPECT_TRUE(WaitUntil([&] { return !Exists(grandchild); }));
  }

  TemporaryFolder folder_;
  std::filesystem::path note_ = folder_.Path() / "grandchild";
};

TEST_F(Wrapper, DiesWithItsChildWhenThisProcessIsKilled) {
  const pid_t parent = fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    RunProcess(Request("wait"));
    _exit(0);
  }
  EXPECT_TRUE(Exists(Grandchild()));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  ExpectGrandchildDied();
}

TEST_F(Wrapper, DiesWithItsChildAtATimeout) {
  ProcessRequest request = Request("wait");
  request.timeout_s = 0.5;
  EXPECT_TRUE(RunProcess(request).timed_out);
  ExpectGrandchildDied();
}

TEST_F(Wrapper, LeavesNoChildBehind) {
  const std::string until_noted = "while [ ! -e " + note_.string() + " ]; do sleep 0.01; done; ";
  EXPECT_EQ(RunProcess(Request(until_noted + "exit 4")).exit_code, 4);
  ExpectGrandchildDied();
}

TEST(RunProcess, LeavesNoChildOfOurs) {
  EXPECT_TRUE(RunProcess(Shell("exit 0")).Succeeded());
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST(RunProcess, HearsTheExitCodeThoughChildrenWereIgnored) {
  const auto before = signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(RunProcess(Shell("exit 3")).exit_code, 3);
  signal(SIGCHLD, before);
}

TEST(RunProcess, NamesThePathLookupOfAMissingProgram) {
  const std::string message =
      MessageOf<ToolError>([] { RunProcess({.program = "no-such-program-anywhere"}); });
  EXPECT_THAT(message, HasSubstr("no-such-program-anywhere"));
  EXPECT_THAT(message, HasSubstr("PATH"));
}

TEST(RunProcess, RefusesAFileThatIsNoProgram) {
  const TemporaryFolder folder;
  const auto file = folder.Path() / "program";
  std::ofstream(file) << "neither script nor binary";
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  EXPECT_THAT(MessageOf<ToolError>([&] { RunProcess({.program = file.string()}); }),
              HasSubstr("cannot be started"));
}

TEST(RunTool, SaysHowItEndedWithTheLastLinesAndTheLog) {
  const TemporaryFolder folder;
  ProcessRequest request = Shell("for i in 1 2 3 4 5 6 7; do echo line $i; done; exit 9");
  request.log_path = folder.Path() / "tool.log";
  const std::string message = MessageOf<ToolError>([&] { RunTool(request, "counting"); });
  EXPECT_THAT(message, HasSubstr("counting: 'sh -c"));
  EXPECT_THAT(message, HasSubstr("exit code 9"));
  EXPECT_THAT(message, HasSubstr("line 3 | line 4 | line 5 | line 6 | line 7"));
  EXPECT_THAT(message, Not(HasSubstr("line 2 |")));
  EXPECT_THAT(message, HasSubstr(request.log_path.string()));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

TEST(RunTool, NamesTheSignal) {
  EXPECT_THAT(MessageOf<ToolError>([] { RunTool(Shell("kill -SEGV $$"), "crashing"); }),
              HasSubstr("SIGSEGV"));
}

}  // namespace
}  // namespace rigmap
