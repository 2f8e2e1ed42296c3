// The built programs, run as a user runs them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rigmap {

inline constexpr const char* kPython = "/usr/bin/python3";  // Debian's: it has numpy and scipy

struct ProgramEnd {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;

  std::string LastErrorLine() const;
};

// Runs `program` (a path, or a name on PATH) in `folder` and waits.
ProgramEnd RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                      const std::filesystem::path& folder = ".");
// The program under test.
ProgramEnd RunRigmap(const std::vector<std::string>& arguments,
                     const std::filesystem::path& folder = ".");

// Starts the program under test, its output thrown away, and does not wait.
pid_t StartRigmap(const std::vector<std::string>& arguments);
// Ends it at once, as a power failure would, and waits until it is gone.
void KillHard(pid_t process);
// Sends it a signal, waits, and returns the signal that it ended by; 0 if it ended by itself.
int EndBySignal(pid_t process, int signal);
// How many processes have a command line that names the folder.
int ProcessesOn(const std::filesystem::path& folder);

// The folder that write_simulated_part made, once, when the tests were built.
std::filesystem::path SimulatedPartFolder();
// A copy of it in `folder`/data that a test may spoil.
std::filesystem::path CopyOfSimulatedPart(const std::filesystem::path& folder);

// All paths below `folder`, relative to it, sorted.
std::vector<std::string> FilesIn(const std::filesystem::path& folder);

}  // namespace rigmap
