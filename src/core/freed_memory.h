// What becomes of memory that is given back to the allocator.
#pragma once

namespace rigmap {

// From now on it stays with this process, for whatever is asked for next. Otherwise glibc maps each
// large block anew, and the kernel fills every page of it with zeros: for the cost volumes of
// semi-global matching a tenth of a part's time. To be called before there are threads. Elsewhere
// than with glibc neither of the two does anything.
void KeepFreedMemory();

// Back to the system with all that is free now, if this process has more than so many megabytes.
// Blocks of changing sizes leave gaps that no other fits into.
void ReturnFreedMemory(double if_above_mb = 0.0);

}  // namespace rigmap
