// Where the files that come with the programs lie.
#pragma once

#include <filesystem>
#include <string>

namespace rigmap {

// config/NAME above the running program: in the source or build tree, or under share/rigmap where
// it is installed; a path relative to the working folder if there is none.
std::filesystem::path ConfigFile(const std::string& name);

}  // namespace rigmap
