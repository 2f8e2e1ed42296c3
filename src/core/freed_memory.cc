#include "core/freed_memory.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>

#include <limits>

#include "core/memory_peak.h"
#endif

namespace rigmap {

#ifdef __GLIBC__
void KeepFreedMemory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  // Arenas of threads cannot hold what is larger than 64 MB: all use the first.
  mallopt(M_ARENA_MAX, 1);
}

void ReturnFreedMemory(double if_above_mb) {
  if (ResidentMegabytes() > if_above_mb) malloc_trim(0);
}
#else
void KeepFreedMemory() {}
void ReturnFreedMemory(double) {}
#endif

}  // namespace rigmap
