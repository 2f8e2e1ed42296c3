// What is odd about data that can be used all the same: sentences for people.
#pragma once

#include <string>
#include <vector>

#include "core/stamp.h"
#include "scene/survey.h"

namespace rigmap {

// Of the stamps of a part's pairs, in order of time: those that follow one another too closely.
std::vector<std::string> RemarksOnStamps(const std::vector<StampNs>& stamps);

// Of a part's fixes, in order of time: those of RTK_FIXED that the rover cannot have reached from
// the one before, as fast as it usually is.
std::vector<std::string> RemarksOnFixes(const std::vector<GnssFix>& fixes);

// From when to when a part's pairs are; seconds.
struct PartSpan {
  std::string name;
  double first_s = 0.0, last_s = 0.0;
};
// How the later of two parts lies to the earlier; empty where it begins at most `longest_s` after
// it.
std::string RemarkOnNeighbours(const PartSpan& earlier, const PartSpan& later, double longest_s);

}  // namespace rigmap
