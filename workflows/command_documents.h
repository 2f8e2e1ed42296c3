// What the command line says of itself: examples, completion for the shell, a page of manual. All
// from the commands as they are declared.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace rigmap {

// Puts examples in front of what each command's --help ends with. After all commands were added.
void AddExamples(CLI::App& app);

// For bash, and zsh with bashcompinit: `source <(rigmap completion)`.
std::string BashCompletion(const CLI::App& app);

// In the form of man: `rigmap manual | man -l -`.
std::string ManualPage(const CLI::App& app);

}  // namespace rigmap
