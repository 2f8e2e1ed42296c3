#include "workflows/compared_rows.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/file.h"
#include "core/json_file.h"
#include "core/json_text.h"
#include "workflows/comparison_runs.h"
#include "workflows/output_folder.h"
#include "workflows/part_folder.h"
#include "workflows/part_options.h"
#include "workflows/recipes.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Where a technique stands among all; those of other releases last.
std::size_t OrderOf(const std::string& technique) {
  constexpr auto kNames = NamesOf(Technique{});
  return static_cast<std::size_t>(std::ranges::find(kNames, technique) - kNames.begin());
}

void SortRows(std::vector<ComparisonRow>& rows) {
  std::ranges::sort(rows, {}, [](const ComparisonRow& row) {
    return std::tuple(row["part"].get<std::string>(), OrderOf(row["technique"]),
                      row["setting"].get<std::string>(), row["repeat"].get<int>());
  });
}

bool IsRow(const ComparisonRow& row) {
  const auto is_text = [&](const char* key) { return row.contains(key) && row[key].is_string(); };
  return row.is_object() && is_text("part") && is_text("technique") && is_text("setting") &&
         is_text("status") && row.contains("repeat") && row["repeat"].is_number_integer();
}

// How its options differ from the defaults; nothing where another release wrote them.
std::string SettingOfResult(const fs::path& out) {
  try {
    const PartOptions options = LoadPartOptions(out / "config.yaml", {});
    return fmt::format("{}", fmt::join(ListChangedOptions(options), " "));
  } catch (const std::exception& error) {
    spdlog::warn("{}; its setting is not told", error.what());
    return "";
  }
}

// Names for the data of results, by their marks: equal for equal frames alone.
std::vector<std::string> NamesOfData(const std::vector<PartFolder>& results) {
  std::map<std::string, std::string> names;  // by the frames
  std::set<std::string> taken;
  std::vector<std::string> of_results;
  for (const PartFolder& result : results) {
    const FolderMark mark = MarkIn(result.root).value_or(FolderMark{result.name, result.name});
    auto& name = names[mark.frames];
    if (name.empty()) {
      name = mark.description;
      for (int i = 2; !taken.insert(name).second; ++i) {
        name = fmt::format("{} ({})", mark.description, i);
      }
    }
    of_results.push_back(name);
  }
  return of_results;
}

}  // namespace

std::vector<ComparisonRow> StoredRows(const fs::path& out) {
  std::vector<ComparisonRow> rows;
  for (const fs::path& part : FoldersIn(out / "runs")) {
    for (const fs::path& label : FoldersIn(part)) {
      for (const auto& entry : fs::directory_iterator(label)) {
        if (entry.path().extension() != ".json") continue;
        auto row = ComparisonRow::parse(ReadTextFile(entry.path()), nullptr, false);
        if (IsRow(row)) {
          rows.push_back(std::move(row));
        } else {
          spdlog::warn("{}: expected the row of a run, found something else; left out",
                       entry.path().string());
        }
      }
    }
  }
  SortRows(rows);
  return rows;
}

std::vector<ComparisonRow> RowsOf(const std::vector<fs::path>& outs) {
  const std::vector<PartFolder> results = NameParts(outs);
  const std::vector<std::string> data = NamesOfData(results);
  std::vector<ComparisonRow> rows;
  std::map<std::string, int> alike;
  const auto key = [](const ComparisonRow& row) {
    return JsonText(row["part"]) + JsonText(row["technique"]) + JsonText(row["setting"]);
  };
  for (std::size_t i = 0; i < results.size(); ++i) {
    ComparisonRow row = MakeRow({.part = data[i], .run = results[i].root}, results[i].root);
    const fs::path path = results[i].root / "summary.json";
    row["technique"] = TakeFromJson(path, "the summary of a run", [&] {
      return nlohmann::json::parse(ReadTextFile(path)).value("technique", "rig");
    });
    row["setting"] = SettingOfResult(results[i].root);
    ++alike[key(row)];
    rows.push_back(std::move(row));
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (alike[key(rows[i])] == 1) continue;
    const std::string setting = rows[i]["setting"];
    rows[i]["setting"] =
        fmt::format("{}{}in {}", setting, setting.empty() ? "" : " ", results[i].name);
  }
  SortRows(rows);
  return rows;
}

}  // namespace rigmap
