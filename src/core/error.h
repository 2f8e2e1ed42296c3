// The kinds of failure rigmap reports. Each message is one sentence that names the file or id, what
// was expected and what was found. Doubtful quality is not an error: it is a gate (scene/gate.h).
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace rigmap {

// One line whatever was found in a file: control characters as \xNN (line ends as \n), and of more
// than 1000 characters the first 600 and the last 300.
std::string Legible(std::string_view sentence);

// Base of all failures that are shown to the user as a sentence, which is made legible. Exit
// code 1.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string_view sentence) : std::runtime_error(Legible(sentence)) {}
};

// Input that cannot be used: a missing, malformed or contradictory file.
class DataError : public Error {
 public:
  using Error::Error;
};

// A child process that could not be started, failed or did not do what it should.
class ToolError : public Error {
 public:
  using Error::Error;
};

// A command line or option that cannot be used. Exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

}  // namespace rigmap
