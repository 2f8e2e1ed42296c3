#pragma once

#include <string>

namespace rigmap {

// As a shell takes `word`: as it is, or between single quotes where a shell would read more into
// it.
std::string ShellWord(const std::string& word);

}  // namespace rigmap
