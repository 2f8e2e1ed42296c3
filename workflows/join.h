// `rigmap join`: parts of one drive become one trajectory and one map.
#pragma once

#include <filesystem>
#include <vector>

#include "workflows/part_request.h"
#include "workflows/reconstruct_part.h"

namespace rigmap {

struct JoinRequest {
  std::vector<std::filesystem::path> outs;  // folders that rigmap part has left, in any order
  PartRequest whole;                        // its dataset and technique are not used
  bool use_rtk = false;  // every other turn of fixes ties the poses, the rest judges them
  // Of parts that should be among them, a sentence each: the result is not trusted then.
  std::vector<std::string> missing = {};
};

// Leaves in whole.out what a part's folder holds, of all parts as one. Where nothing measured ties
// some of them to the others, the world with most frames is all that is joined, the rest is named
// and stays as it is, and the result is not trusted. Throws UsageError and DataError, before
// anything is written, where a folder is given twice or holds no part that can be joined, where
// parts were given different rigs or made with different options, where they disagree about a frame
// that they share, and where use_rtk has no fixes or antenna.
PartResult JoinParts(const JoinRequest& request);

}  // namespace rigmap
