#include "dataset/internal/rock_file.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "dataset/internal/text_row.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr std::array kKinds{"small", "medium", "large"};

struct RockList {
  const char* folder;
  const char* traverse;  // in the files' names
};
constexpr RockList kFirstList{"Rock Positions Traverse 1 and 2", "12"};
constexpr RockList kThirdList{"Rock Positions Traverse 3", "3"};

bool IsFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::optional<fs::path> FindRockData(const KatwijkPart& part) {
  const fs::path traverse = part.folder.parent_path();
  for (const fs::path& folder : {part.folder, traverse, traverse.parent_path()}) {
    if (IsFolder(folder / "Rock Data")) return folder / "Rock Data";
  }
  return std::nullopt;
}

std::optional<RockList> ListOf(const KatwijkPart& part, const fs::path& rock_data) {
  if (part.traverse) return *part.traverse == 3 ? kThirdList : kFirstList;
  const bool has_first = IsFolder(rock_data / kFirstList.folder);
  const bool has_third = IsFolder(rock_data / kThirdList.folder);
  if (has_first == has_third) return std::nullopt;
  return has_first ? kFirstList : kThirdList;
}

struct RockRow {
  GridColumns columns = GridColumns::kEastingFirst;
  double first = 0.0, second = 0.0;
};

std::optional<RockRow> ParseRock(std::string_view line, const UtmZone& zone) {
  const auto first = ParseFinite(NextWord(line)), second = ParseFinite(NextWord(line));
  if (!first || !second || !NextWord(line).empty()) return std::nullopt;
  const auto columns = GridColumnsOf(*first, *second, zone);
  if (!columns) return std::nullopt;
  return RockRow{*columns, *first, *second};
}

// A line that is not empty; `row` is nothing where it is no place of the zone.
struct RockLine {
  int number = 0;
  std::string text;
  std::optional<RockRow> row;
};

std::vector<RockLine> ParseRocks(const std::string& text, const UtmZone& zone) {
  std::vector<RockLine> lines;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::string_view words = line;
    if (!NextWord(words).empty()) lines.push_back({number, line, ParseRock(line, zone)});
  }
  return lines;
}

// That the first row shows which cannot be read either way; eastings first where all can.
GridColumns ColumnsOf(const std::vector<RockLine>& lines) {
  for (const RockLine& line : lines) {
    if (line.row && line.row->columns != GridColumns::kEither) return line.row->columns;
  }
  return GridColumns::kEastingFirst;
}

}  // namespace

std::vector<SurveyedLandmark> ReadRockFile(const fs::path& path, const std::string& kind,
                                           const UtmZone& zone) {
  const std::vector<RockLine> lines = ParseRocks(ReadTextFile(path), zone);
  const GridColumns columns = ColumnsOf(lines);
  std::vector<SurveyedLandmark> rocks;
  for (const auto& [number, text, row] : lines) {
    bool fits = row && (row->columns == columns || row->columns == GridColumns::kEither);
    if (fits) {
      const bool easting_first = columns == GridColumns::kEastingFirst;
      const GridPosition position{zone.Epsg(), easting_first ? row->first : row->second,
                                  easting_first ? row->second : row->first};
      fits = rocks.empty() || AreNear(position.northing_m, rocks.front().position.northing_m);
      rocks.push_back({kind, position});
    }
    if (!fits) {
      throw DataError(
          fmt::format("{}:{}: expected easting and northing in UTM {} metres, in the same order "
                      "in all rows, found '{}'",
                      path.string(), number, zone.Name(), text));
    }
  }
  return rocks;
}

std::vector<SurveyedLandmark> ReadRockSurvey(const KatwijkPart& part, const UtmZone& zone) {
  std::vector<SurveyedLandmark> rocks;
  const auto rock_data = FindRockData(part);
  if (!rock_data) return rocks;
  const auto list = ListOf(part, *rock_data);
  if (!list) return rocks;
  for (const std::string kind : kKinds) {
    const fs::path path =
        *rock_data / list->folder / fmt::format("{}-rocks-traverse{}.txt", kind, list->traverse);
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) continue;
    const auto of_kind = ReadRockFile(path, kind, zone);
    rocks.insert(rocks.end(), of_kind.begin(), of_kind.end());
  }
  return rocks;
}

}  // namespace rigmap
