// One --fault NAME=VALUE, taken apart.
#pragma once

#include <string>

#include "core/error.h"
#include "simulation/faults.h"
#include "simulation/internal/noise.h"

namespace rigmap {

struct FaultRequest {
  std::string spec;     // as given
  std::string name;     // before the '='
  std::string value;    // after it
  HashSequence random;  // of its own

  bool IsRange() const { return value.find(':') != std::string::npos; }
};

// "--fault SPEC: expected EXPECTED".
UsageError Complaint(const FaultRequest& request, const std::string& expected);

// The value as a count from 0, a share from 0 to 1, or a range within the frames 0:`frames`. Throw
// UsageError for anything else.
int ParseCount(const FaultRequest& request);
double ParseShare(const FaultRequest& request);
FrameRange ParseRange(const FaultRequest& request, int frames);

}  // namespace rigmap
