#include "tests/workflows/rigmap_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

pid_t Start(const std::string& program, const std::vector<std::string>& arguments,
            const fs::path& folder, const fs::path& out, const fs::path& err) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("cannot fork");
  if (process > 0) return process;
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  if (dup2(open(out.c_str(), kFlags, 0644), STDOUT_FILENO) >= 0 &&
      dup2(open(err.c_str(), kFlags, 0644), STDERR_FILENO) >= 0 && chdir(folder.c_str()) == 0) {
    execvp(program.c_str(), argv.data());
  }
  _exit(127);
}

}  // namespace

std::string ProgramEnd::LastErrorLine() const {
  const auto end = err.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const auto before = err.rfind('\n', end);
  return err.substr(before == std::string::npos ? 0 : before + 1, end - before);
}

ProgramEnd RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                      const fs::path& folder) {
  const TemporaryFolder output;
  const fs::path out = output.Path() / "out", err = output.Path() / "err";
  int status = 0;
  waitpid(Start(program, arguments, folder, out, err), &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadTextFile(out), ReadTextFile(err)};
}

ProgramEnd RunRigmap(const std::vector<std::string>& arguments, const fs::path& folder) {
  return RunProgram(RIGMAP_PROGRAM, arguments, folder);
}

pid_t StartRigmap(const std::vector<std::string>& arguments) {
  return Start(RIGMAP_PROGRAM, arguments, ".", "/dev/null", "/dev/null");
}

void KillHard(pid_t process) { EndBySignal(process, SIGKILL); }

int EndBySignal(pid_t process, int signal) {
  kill(process, signal);
  int status = 0;
  waitpid(process, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

int ProcessesOn(const fs::path& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "cmdline");
    std::string command;
    std::getline(file, command);
    if (command.find(folder.string()) != std::string::npos) ++count;
  }
  return count;
}

fs::path SimulatedPartFolder() { return RIGMAP_SIMULATED_PART; }

fs::path CopyOfSimulatedPart(const fs::path& folder) {
  fs::copy(SimulatedPartFolder(), folder / "data", fs::copy_options::recursive);
  return folder / "data";
}

std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    files.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace rigmap
