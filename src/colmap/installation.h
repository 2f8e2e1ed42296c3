// The COLMAP that this machine offers.
#pragma once

#include <string>

#include "core/options.h"

namespace rigmap {

struct ColmapOptions {
  static constexpr const char* kSection = "colmap";

  double patience_s = 900.0;

  OptionFields Fields();
};

struct ColmapInstallation {
  std::string path;          // of the program
  std::string version_text;  // "3.8"
  double patience_s = ColmapOptions().patience_s;
};

// Looks `colmap` up on PATH and asks it for its version. This release knows the options and the
// tables of 3.8 only: any other version is refused with a ToolError that says what was found and
// where, and so is a program that fails, hangs (killed after `patience_s`) or names no version.
ColmapInstallation FindColmap(double patience_s = 20.0);

}  // namespace rigmap
