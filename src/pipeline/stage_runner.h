// Runs a recipe in an output folder: does what is not there yet, and knows what is.
#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/job.h"
#include "pipeline/internal/make_stage.h"
#include "pipeline/internal/schedule.h"
#include "pipeline/internal/stage_files.h"
#include "pipeline/ledger.h"
#include "pipeline/run_plan.h"
#include "pipeline/stage_graph.h"

namespace rigmap {

// Layout: stages/<stage>-<key>.bin holds a product, stages/ledger.json what there is,
// logs/<stage>.log the messages of a stage, stages/scratch-<stage> what it needs no longer than it
// works.
//
// Stages are done one after the other, in the order of the recipe. One that waits for a child
// process goes on in a thread of its own meanwhile, until something takes what it makes.
//
// The key of a stage is a hash of its code, the options that it reads and the keys of what it
// takes. A product kept with the same key is taken up, whichever recipe or machine made it. Of each
// stage the latest two products are kept. A stage counts as done once it is published, its product
// kept and its record written, in this order, so that a run killed at any moment is taken up by the
// next.
class StageRunner {
 public:
  // Opens the sources that are needed. `graph` must outlive this. Writes nothing.
  StageRunner(const StageGraph& graph, std::filesystem::path root, RunPlan plan);

  // Files and folders in the output folder, relative to it, that Run will remove before it begins:
  // they were made from other inputs, options or code, or --from asks for them anew.
  const std::vector<std::string>& outdated_outputs() const { return outdated_.outputs; }
  // The stages that published them, or only kept something that does not hold any more.
  const std::vector<std::string>& outdated_stages() const { return outdated_.stages; }

  // Throws what a stage throws; what was done before stays, as does what was still under way beside
  // it, and of that stage nothing is left.
  void Run(Job& job);

  // What the folder holds, in the order of the recipe.
  const Ledger& ledger() const { return ledger_; }

 private:
  // A stage that is at work in a thread of its own.
  struct UnderWay {
    std::size_t index = 0;
    std::future<MadeStage> made;
  };

  void Clear();
  // Of `left`, in their order, the first that waits for none of the others nor for what is under
  // way.
  std::optional<std::size_t> FirstReady(const std::vector<std::size_t>& left) const;
  void Do(std::size_t index, Job& job);
  void DoSource(std::size_t index);
  void DoCheck(std::size_t index);
  void DoStage(std::size_t index, Job& job);
  // Of a stage that is kept; nothing where it is to be made.
  std::optional<StageRecord> Reused(std::size_t index, const StageContext& context);
  void FinishFirstUnderWay();
  void Record(std::size_t index, MadeStage made);
  MadeStage Make(std::size_t index, const StageContext& context,
                 const StageNode::Inputs& inputs) const;
  std::vector<std::string> Publish(std::size_t index, const StageContext& context);
  // Whether the kept product can be read and what it names is there; it is in memory then.
  bool IsWhole(std::size_t index, const StageContext& context);
  // The product: as it is in memory, or kept, or made now.
  const std::any& Get(std::size_t index);
  StageNode::Inputs InputsOf(std::size_t index);
  // Forgets what none of `left` and of what is under way takes.
  void Release(const std::vector<std::size_t>& left);
  // The record, if it speaks of the node's present key.
  const StageRecord* ValidRecord(std::size_t index) const;
  std::filesystem::path ProductPath(std::size_t index) const;
  StageContext ContextOf(std::size_t index) const;
  void Put(std::size_t index, StageRecord record);

  const StageGraph& graph_;
  std::filesystem::path root_;
  StageFiles files_;
  RunPlan plan_;
  Ledger ledger_;
  Schedule schedule_;
  Outdated outdated_;
  std::vector<std::any> products_;  // of each node, while it is in memory
  std::vector<UnderWay> under_way_;
};

}  // namespace rigmap
