// Memory among jobs that are at work at the same time.
#pragma once

namespace rigmap {

// Of the program itself, whatever it does (docs/traverse.md).
inline constexpr double kProgramMegabytes = 150.0;

// Megabytes that the calling thread's job may still take of what the whole process is allowed: an
// even share of what is free now. Negative where nothing is.
double MemoryShare(double allowed_mb);

}  // namespace rigmap
