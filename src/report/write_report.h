// report.html: one file in which a person sees whether to trust a result, and walks through it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/stamp.h"

namespace rigmap {

struct ReportRequest {
  std::filesystem::path folder;              // of a part, a traverse or a comparison
  std::vector<std::string> changed_options;  // for people, a line each
  // Left images, where the caller knows them; else those that colmap/images still leads to.
  std::map<StampNs, std::filesystem::path> images;
  std::size_t max_points = 1'000'000;  // of the map, in the 3-D view
};

// Writes folder/report.html from what lies in the folder. It holds numbers of the run such as time
// and memory: equal runs need not give equal bytes. Takes about 2 s and 500 MB for a million
// points. Throws DataError, a sentence, for a folder without a finished result.
void WriteReport(const ReportRequest& request);

}  // namespace rigmap
