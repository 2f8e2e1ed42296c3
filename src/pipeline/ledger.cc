#include "pipeline/ledger.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "core/json_text.h"

namespace rigmap {
namespace {

std::filesystem::path LedgerPath(const std::filesystem::path& root) {
  return root / "stages" / "ledger.json";
}

StageRecord ReadRecord(const Report& json) {
  StageRecord record;
  record.name = json.at("name");
  record.key = json.at("key");
  record.seconds = json.at("seconds");
  record.peak_rss_mb = json.at("peak_rss_mb");
  record.published = json.at("published").get<std::vector<std::string>>();
  record.declared = json.value("declared", std::vector<std::string>());
  if (json.contains("bytes")) record.bytes = json.at("bytes");
  record.listed = json.at("listed");
  record.report = json.at("report");
  record.reused = true;
  return record;
}

}  // namespace

const StageRecord* Ledger::Find(const std::string& name) const {
  const auto found = std::ranges::find(stages, name, &StageRecord::name);
  return found == stages.end() ? nullptr : &*found;
}

void Ledger::Put(StageRecord record) {
  const auto found = std::ranges::find(stages, record.name, &StageRecord::name);
  if (found == stages.end()) {
    stages.push_back(std::move(record));
  } else {
    *found = std::move(record);
  }
}

void Ledger::Remove(const std::string& name) {
  std::erase_if(stages, [&](const StageRecord& record) { return record.name == name; });
}

Ledger ReadLedger(const std::filesystem::path& root) {
  const auto path = LedgerPath(root);
  if (!std::filesystem::exists(path)) return {};
  try {
    const auto json = Report::parse(ReadTextFile(path));
    Ledger ledger{.recipe = json.at("recipe"), .stages = {}};
    for (const auto& record : json.at("stages")) ledger.stages.push_back(ReadRecord(record));
    return ledger;
  } catch (const nlohmann::json::exception& error) {
    spdlog::warn("{}: damaged, its stages are made anew: {}", path.string(), error.what());
    return {};
  }
}

void WriteLedger(const Ledger& ledger, const std::filesystem::path& root) {
  Report json = {{"recipe", ledger.recipe}, {"stages", Report::array()}};
  for (const StageRecord& record : ledger.stages) {
    json["stages"].push_back({{"name", record.name},
                              {"key", record.key},
                              {"seconds", record.seconds},
                              {"peak_rss_mb", record.peak_rss_mb},
                              {"published", record.published},
                              {"declared", record.declared},
                              {"bytes", record.bytes},
                              {"listed", record.listed},
                              {"report", record.report}});
  }
  WriteFileAtomically(LedgerPath(root),
                      [&](std::ostream& stream) { stream << JsonText(json, 1) << '\n'; });
}

void RecordSizes(const std::filesystem::path& root, Ledger& ledger) {
  namespace fs = std::filesystem;
  for (StageRecord& record : ledger.stages) {
    record.bytes.clear();
    const auto put = [&](const fs::directory_entry& entry) {
      if (!entry.is_regular_file() || entry.is_symlink()) return;
      record.bytes[entry.path().lexically_relative(root).generic_string()] = entry.file_size();
    };
    for (const std::string& name : record.published) {
      const fs::path path = root / name;
      if (fs::is_directory(path)) {
        std::ranges::for_each(fs::recursive_directory_iterator(path), put);
      } else if (fs::exists(path)) {
        put(fs::directory_entry(path));
      }
    }
  }
}

bool IsPublished(const StageRecord& record, const std::filesystem::path& root) {
  const auto is_there = [&](const std::string& name) {
    std::error_code ignored;
    return std::filesystem::exists(root / name, ignored);
  };
  const auto is_whole = [&](const auto& file) {
    std::error_code error;
    return std::filesystem::file_size(root / file.first, error) == file.second && !error;
  };
  return std::ranges::all_of(record.published, is_there) &&
         std::ranges::all_of(record.bytes, is_whole);
}

}  // namespace rigmap
