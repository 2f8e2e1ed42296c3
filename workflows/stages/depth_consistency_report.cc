#include "workflows/stages/depth_consistency_report.h"

#include <utility>

namespace rigmap {
namespace {

Report ReportRegion(Report region, const std::optional<RegionDifference>& difference) {
  region["tracks"] = difference ? Report(difference->tracks) : Report(nullptr);
  const auto add = [&](const char* name, const char* sigma_name,
                       MeanDifference RegionDifference::*member) {
    region[name] = difference ? Report(((*difference).*member).mean) : Report(nullptr);
    region[sigma_name] = difference ? Report(((*difference).*member).sigma) : Report(nullptr);
  };
  add("disparity_px", "disparity_sigma_px", &RegionDifference::disparity_px);
  add("depth_pct", "depth_sigma_pct", &RegionDifference::depth_pct);
  return region;
}

Report ReportSystematic(const DepthPartition& partition) {
  return {{"systematic_px", partition.disparity_px.value},
          {"systematic_sigma_px", partition.disparity_px.sigma},
          {"systematic_pct", partition.depth_pct.value},
          {"systematic_sigma_pct", partition.depth_pct.sigma}};
}

}  // namespace

Report ReportDepthConsistency(const std::optional<DepthConsistency>& consistency) {
  if (!consistency) return nullptr;
  Report radius = ReportSystematic(consistency->radius),
         cells = ReportSystematic(consistency->cells);
  radius["rings"] = Report::array();
  for (int ring = 0; ring < DepthConsistency::kRings; ++ring) {
    radius["rings"].push_back(ReportRegion({{"from_px", ring * consistency->ring_width_px},
                                            {"to_px", (ring + 1) * consistency->ring_width_px}},
                                           consistency->radius.regions[ring]));
  }
  cells["cells"] = Report::array();
  for (int i = 0; i < DepthConsistency::kRows * DepthConsistency::kColumns; ++i) {
    cells["cells"].push_back(ReportRegion(
        {{"row", i / DepthConsistency::kColumns}, {"column", i % DepthConsistency::kColumns}},
        consistency->cells.regions[i]));
  }
  return {{"radius", std::move(radius)}, {"place", std::move(cells)}};
}

}  // namespace rigmap
