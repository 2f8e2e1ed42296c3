// A part or traverse as its page tells of it: what was read, and what was made of that.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "report/map_views.h"
#include "report/point_planes.h"
#include "report/result_folder.h"
#include "report/sparse_statistics.h"
#include "report/thin_cloud.h"

namespace rigmap {

struct PartContent {
  ResultFolder folder;
  std::vector<std::string> changed_options;  // "stage.option=value (default: value)"
  std::optional<SparseStatistics> sparse;
  std::optional<ThinCloud> cloud;
  PackedPoints points;
  std::optional<MapViews> views;
  Json map;  // figures of the map that stand in no file; the report's data holds them
  std::map<StampNs, std::string> thumbnails;  // data URLs

  FigureSource Map() const { return {"map", map}; }
};

// The sections of a page, each HTML, empty where there is nothing to tell.
std::string VerdictSection(const PartContent& content);  // the first screen
std::string ViewSection(const PartContent& content);     // 3-D, pictures in its stead
std::string PartsSection(const PartContent& content);    // of a traverse
std::string RouteSection(const PartContent& content);
std::string EvaluationSection(const PartContent& content);
std::string CalibrationSection(const PartContent& content);
std::string TracksSection(const PartContent& content);
std::string FramesSection(const PartContent& content);
std::string GatesSection(const PartContent& content);
std::string MapSection(const PartContent& content);
std::string RunSection(const PartContent& content);

// The frames that FramesSection shows first: at most 40.
std::set<StampNs> FramesThatStandOut(const PartContent& content);

// Whether the poses' sigmas hold what the calibration leaves unknown.
bool IsCalibrationInSigmas(const PartContent& content);

// The curves that the scripts draw into the sections.
Json Charts(const PartContent& content);

// For the scripts: poses, reference, rocks, points, and the curves that they draw into the
// sections.
Json PageData(const PartContent& content);

// From how many images each spot of the map is seen, and how high it lies, as SVG; empty where that
// is not known.
std::string CellDrawings(const PartContent& content);

// Route, reference, rocks and enlarged sigmas from above, as SVG; empty without a path.
std::string RouteDrawing(const PartContent& content);

}  // namespace rigmap
