#include "report/write_report.h"

#include <spdlog/spdlog.h>

#include <ostream>

#include "core/error.h"
#include "core/file.h"
#include "report/page.h"
#include "report/part_content.h"
#include "report/pictures.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kListedRocks = 15;

std::optional<ThinCloud> ReadMap(const fs::path& root, std::size_t max_points) {
  for (const char* name : {"dense.ply", "sparse.ply"}) {
    if (!fs::exists(root / name)) continue;
    try {
      ThinCloud cloud = ReadThinCloud(root / name, max_points);
      if (!cloud.points.empty()) return cloud;
    } catch (const DataError& error) {
      spdlog::warn("left out of the report: {}", error.what());
    }
  }
  return std::nullopt;
}

Json DescribeRock(const SegmentedRock& rock) {
  return {{"height_m", rock.height_m},
          {"width_m", rock.width_m},
          {"x_m", rock.centre.x()},
          {"y_m", rock.centre.y()}};
}

// What is counted in the map and stands in no other file.
Json DescribeMap(const ThinCloud& cloud, const Json& summary) {
  Json map = {{"points", cloud.count_in_map}, {"points_shown", cloud.points.size()}};
  if (cloud.finest_m > 0.0) map["finest_m"] = cloud.finest_m;
  if (cloud.median_sigma_m) map["median_sigma_m"] = *cloud.median_sigma_m;
  if (cloud.median_observations) map["median_observations"] = *cloud.median_observations;
  if (cloud.area_m2 > 0.0) {
    map["area_m2"] = cloud.area_m2;
    map["points_per_m2"] = static_cast<double>(cloud.count_in_map) / cloud.area_m2;
  }
  if (!cloud.rocks) return map;
  map["rocks"] = cloud.rocks->size();
  for (const SegmentedRock& rock : *cloud.rocks) {
    if (map["largest_rocks"].size() >= kListedRocks) break;
    map["largest_rocks"].push_back(DescribeRock(rock));
  }
  if (!cloud.rocks->empty()) {
    map["largest_rock"] = DescribeRock(cloud.rocks->front());
    // The difference of two heights, each as good as a point of the map, and the scale.
    if (cloud.median_sigma_m) {
      constexpr double kSigmasOf95Pct = 1.96;
      const Json& scale_95_pct = At(summary, "/verdict/scale_95_pct");
      const double of_scale = scale_95_pct.is_number() ? scale_95_pct.get<double>() / 100.0 : 0.0;
      map["largest_rock"]["height_95_m"] =
          std::hypot(kSigmasOf95Pct * std::sqrt(2.0) * *cloud.median_sigma_m,
                     of_scale * cloud.rocks->front().height_m);
    }
  }
  return map;
}

void AddViews(PartContent& content) {
  const auto& sparse = content.folder.sparse;
  const Camera* left = sparse ? LeftCameraOf(*sparse) : nullptr;
  if (!left) return;
  content.views = ViewsOf(content.cloud->points, *left, content.folder.trajectory);
  if (!content.views) return;
  content.map["median_images"] = content.views->median_images;
  content.map["pixel_m"] = content.views->median_pixel_m;
}

Page PageOfPart(ResultFolder folder, const ReportRequest& request) {
  if (!request.images.empty()) folder.images = request.images;
  PartContent content{.folder = std::move(folder), .changed_options = request.changed_options};
  if (content.folder.sparse) content.sparse = StatisticsOf(*content.folder.sparse);
  content.cloud = ReadMap(content.folder.root, request.max_points);
  if (content.cloud) {
    content.points = PackPoints(content.cloud->points, content.cloud->finest_m);
    content.map = DescribeMap(*content.cloud, content.folder.summary);
    AddViews(content);
  }
  content.thumbnails = Thumbnails(content.folder.images, FramesThatStandOut(content));
  return PartPage(content);
}

}  // namespace

void WriteReport(const ReportRequest& request) {
  ResultFolder folder = ReadResultFolder(request.folder);
  const std::string text =
      WritePage(folder.kind == ResultKind::kComparison ? ComparisonPage(folder)
                                                       : PageOfPart(std::move(folder), request));
  WriteFileAtomically(request.folder / "report.html",
                      [&](std::ostream& stream) { stream << text; });
}

}  // namespace rigmap
