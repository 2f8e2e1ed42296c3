// What an output folder holds, stage by stage: kept beside the products as stages/ledger.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/stage.h"

namespace rigmap {

struct StageRecord {
  std::string name;
  std::string key;
  double seconds = 0.0;                // when it was made
  double peak_rss_mb = 0.0;            // of this process or its largest child while it was made
  std::vector<std::string> published;  // relative to the output folder
  // What it might have published. Another recipe may leave some of that to a later stage.
  std::vector<std::string> declared;
  // Of each of these files and of those in these folders when the run ended; empty until then.
  std::map<std::string, std::uintmax_t> bytes;
  bool listed = true;  // among the stages: sources without a report and checks are not
  Report report;
  bool reused = false;  // by this run; not kept
};

struct Ledger {
  std::string recipe;  // that made it
  std::vector<StageRecord> stages;

  const StageRecord* Find(const std::string& name) const;
  // Takes the place of the record of that name.
  void Put(StageRecord record);
  void Remove(const std::string& name);
};

// Empty where there is none, or one that cannot be read: then what lies there is made anew.
Ledger ReadLedger(const std::filesystem::path& root);
void WriteLedger(const Ledger& ledger, const std::filesystem::path& root);

// How large what was published is now: a file of another size is none of ours any more.
void RecordSizes(const std::filesystem::path& root, Ledger& ledger);
// Whether all of it is there, as large as it was when that was recorded.
bool IsPublished(const StageRecord& record, const std::filesystem::path& root);

}  // namespace rigmap
