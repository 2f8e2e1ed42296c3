#include "core/memory_share.h"

#include "core/job.h"
#include "core/memory_peak.h"

namespace rigmap {

double MemoryShare(double allowed_mb) {
  const Job* job = Job::Current();
  return (allowed_mb - ResidentMegabytes()) / (job ? job->sharing() : 1);
}

}  // namespace rigmap
