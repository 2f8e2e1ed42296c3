// What dead reckoning needs of a part's sensors.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "dead_reckoning/internal/sensor_steps.h"
#include "scene/dataset.h"

namespace rigmap {

// Throws DataError where there are no samples, or none that can be used. `without`: what to do
// then, if anything.
template <class Record>
void RequireRecord(const Record& record, const char* what, const std::string& without) {
  if (!record.problem.empty()) throw DataError(record.problem + without);
  if (record.samples.empty()) {
    throw DataError(fmt::format("expected samples of the {}, found none{}", what, without));
  }
}

// Throws DataError where samples are further apart than that between the first and the last image.
template <class Record>
void RequireNoGap(const Record& record, const char* file, const Dataset& dataset,
                  double max_gap_s) {
  std::vector<StampNs> stamps_ns;
  for (const auto& sample : record.samples) stamps_ns.push_back(sample.stamp_ns);
  const StampNs begin_ns = dataset.frames.front().stamp_ns;
  const auto gap = FindGap(stamps_ns, begin_ns, dataset.frames.back().stamp_ns, max_gap_s);
  if (!gap) return;
  throw DataError(fmt::format(
      "{}: expected rows at least every {} s between the first and the last image, found none for "
      "{:.2f} s, {:.2f} s after the first",
      file, max_gap_s, gap->duration_s, 1e-9 * static_cast<double>(gap->begin_ns - begin_ns)));
}

}  // namespace rigmap
