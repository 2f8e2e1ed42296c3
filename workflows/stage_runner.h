// Runs the stages of a part one after the other, skips what is already there, and keeps count.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/artefact.h"
#include "core/memory_peak.h"
#include "workflows/output_folder.h"

namespace rigmap {

inline constexpr std::string_view kStageNames[] = {
    "dataset", "features",   "odometry", "matching", "database",  "mapping",
    "scale",   "adjustment", "dense",    "fusion",   "evaluation"};

bool IsStageName(const std::string& name);
// True if stage `a` comes before stage `b`.
bool ComesBefore(const std::string& a, const std::string& b);

struct StageRecord {
  std::string name;
  double seconds = 0.0;
  double peak_rss_mb = 0.0;  // of this process or its largest child while the stage ran
  bool reused = false;
};

// Thrown by StageRunner after the stage that --until names: the recipe ends there, well.
struct StopAfterStage {};

struct StagePlan {
  OutputLayout layout;
  std::optional<std::string> until, from;  // stage names
  bool quiet = false;
};

// One stage: how to make its product, and what to do with it.
template <class Product>
struct Stage {
  std::string name;
  std::string options;  // text that changes whenever the options do
  std::function<Product()> make;
  // Called with every product, made or reused: what the summary says of it.
  std::function<void(const Product&)> report;
  // Writes what users read of it: called if it was made now, or if one of `published` is missing.
  // A stage without it publishes while it makes, and is made anew if something is missing.
  std::function<void(const Product&)> publish;
  std::vector<std::filesystem::path> published;
};

class StageRunner {
 public:
  explicit StageRunner(StagePlan plan);

  // The product of a stage: as an earlier run left it, if that was made from the same inputs (all
  // stages before this one) and options and --from does not ask for it anew, else made now and
  // kept. It counts as kept only once it is published, and what this and later stages published
  // before is removed first: at no moment do files of different products lie side by side. A stage
  // that fails leaves nothing that it published. The stage's messages go to its log file.
  template <class Product>
  Product Run(const Stage<Product>& stage) {
    Begin(stage.name, stage.options);
    const auto path = plan_.layout.Artefact(stage.name);
    std::optional<Product> product;
    const bool complete = AllExist(stage.published);
    if (MayReuse(stage.name) && (complete || stage.publish)) {
      product = ReadArtefact<Product>(path, key_);
    }
    const bool reused = product.has_value();
    try {
      if (!reused) {
        RemoveFrom(stage.name);
        product = stage.make();
      }
      if (stage.publish && !(reused && complete)) stage.publish(*product);
      if (!reused) WriteArtefact(path, key_, *product);
    } catch (...) {
      if (!reused) Discard(stage.name);
      throw;
    }
    if (stage.report) stage.report(*product);
    End(stage.name, reused);
    return std::move(*product);
  }

  const OutputLayout& layout() const { return plan_.layout; }
  const std::vector<StageRecord>& records() const { return records_; }
  // False if --from asks for this stage, or one before it, to be done anew.
  bool MayReuse(const std::string& name) const;

 private:
  void Begin(const std::string& name, const std::string& options);
  void End(const std::string& name, bool reused);
  // The artefact of this stage, and what it and all later ones published.
  void RemoveFrom(const std::string& name) const;
  // The same, as far as it can be done, after a failure.
  void Discard(const std::string& name) const;
  static bool AllExist(const std::vector<std::filesystem::path>& paths);

  StagePlan plan_;
  std::string key_ = RIGMAP_VERSION;  // of the stage at hand; each contains the one before
  double started_s_ = 0.0;
  double children_peak_mb_ = 0.0;
  std::optional<MemoryPeak> memory_;  // of the stage at hand
  std::vector<StageRecord> records_;
};

}  // namespace rigmap
