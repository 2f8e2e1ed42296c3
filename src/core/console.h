// What a program says to people, on standard error, and what it was asked for, on standard output.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace rigmap {

// To standard error, at once. Never fails: where nobody can be told, work goes on and its outcome
// is the exit code.
void SayText(std::string_view text) noexcept;

template <class... Args>
void Say(fmt::format_string<Args...> format, Args&&... args) {
  SayText(fmt::format(format, std::forward<Args>(args)...));
}

// To standard output, at once. Throws DataError where not all of it could be written: whoever reads
// it must not take a part for the whole.
void PrintResult(std::string_view text);

}  // namespace rigmap
