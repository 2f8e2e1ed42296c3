#include "pipeline/stage_runner.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "core/freed_memory.h"
#include "core/memory_peak.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using Kind = StageNode::Kind;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

StageRunner::StageRunner(const StageGraph& graph, fs::path root, RunPlan plan)
    : graph_(graph),
      root_(std::move(root)),
      files_(root_),
      plan_(std::move(plan)),
      ledger_(ReadLedger(root_)),
      schedule_(MakeSchedule(graph_, plan_, ledger_)),
      outdated_(FindOutdated(graph_, schedule_, ledger_, plan_.known_outputs, root_)),
      products_(std::move(schedule_.sources)) {}

void StageRunner::Clear() {
  files_.RemoveScratch();
  for (const std::string& output : outdated_.outputs) fs::remove_all(root_ / output);
  for (const std::string& stage : outdated_.stages) ledger_.Remove(stage);
  ledger_.recipe = plan_.recipe;
  // In the order of the recipe, whatever was done before.
  std::ranges::stable_sort(ledger_.stages, {},
                           [&](const StageRecord& record) { return graph_.IndexOf(record.name); });
  WriteLedger(ledger_, root_);
}

void StageRunner::Run(Job& job) {
  fs::create_directories(root_ / "logs");
  Clear();
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < graph_.nodes().size(); ++i) {
    if (schedule_.selected[i] && graph_.nodes()[i].kind != Kind::kView) left.push_back(i);
  }
  try {
    while (!left.empty() || !under_way_.empty()) {
      if (const auto ready = FirstReady(left)) {
        std::erase(left, *ready);
        Do(*ready, job);
      } else {
        FinishFirstUnderWay();
      }
      Release(left);
    }
  } catch (...) {
    while (!under_way_.empty()) {
      try {
        FinishFirstUnderWay();
      } catch (const std::exception& also) {
        spdlog::error("{}", also.what());  // what failed first is thrown
      }
    }
    throw;
  }
  job.LogToTerminal();
}

std::optional<std::size_t> StageRunner::FirstReady(const std::vector<std::size_t>& left) const {
  for (const std::size_t index : left) {
    const std::vector<bool> awaited = graph_.Ancestors(index);
    const bool waits =
        std::ranges::any_of(left, [&](std::size_t i) { return i != index && awaited[i]; }) ||
        std::ranges::any_of(under_way_, [&](const UnderWay& u) { return awaited[u.index]; });
    if (!waits) return index;
  }
  return std::nullopt;
}

void StageRunner::Do(std::size_t index, Job& job) {
  const StageNode& node = graph_.nodes()[index];
  if (node.kind != Kind::kSource || node.report) job.LogTo(files_.Log(node.name));
  switch (node.kind) {
    case Kind::kSource:
      return DoSource(index);
    case Kind::kCheck:
      return DoCheck(index);
    case Kind::kStage:
      return DoStage(index, job);
    case Kind::kView:
      return;
  }
}

void StageRunner::DoSource(std::size_t index) {
  const StageNode& node = graph_.nodes()[index];
  StageRecord record{
      .name = node.name, .key = *schedule_.keys[index], .listed = node.report != nullptr};
  record.reused = ValidRecord(index) != nullptr;
  record.report = node.report ? node.report(products_[index], {}) : Report::object();
  Put(index, std::move(record));
}

void StageRunner::DoCheck(std::size_t index) {
  if (const StageRecord* valid = ValidRecord(index)) {
    StageRecord record = *valid;
    record.reused = true;
    return Put(index, std::move(record));
  }
  const StageNode& node = graph_.nodes()[index];
  StageRecord record{.name = node.name, .key = *schedule_.keys[index], .listed = false};
  record.report = node.report(node.make(ContextOf(index), InputsOf(index)), {});
  Put(index, std::move(record));
}

void StageRunner::DoStage(std::size_t index, Job& job) {
  ReturnFreedMemory();
  const double start_s = Now();
  const StageContext context = ContextOf(index);
  if (auto record = Reused(index, context)) {
    spdlog::info("reused, {:.3f} s", Now() - start_s);
    return Put(index, std::move(*record));
  }
  StageNode::Inputs inputs = InputsOf(index);
  if (!graph_.nodes()[index].waits_for_child) return Record(index, Make(index, context, inputs));
  const auto beside = [this, index, context, inputs = std::move(inputs),
                       log = files_.Log(graph_.nodes()[index].name), threads = job.threads(),
                       quiet = job.quiet(), sharing = job.sharing()] {
    Job own(threads, quiet, sharing);
    own.LogTo(log);
    return own.Run([&] { return Make(index, context, inputs); });
  };
  under_way_.push_back({index, std::async(std::launch::async, beside)});
}

std::optional<StageRecord> StageRunner::Reused(std::size_t index, const StageContext& context) {
  const StageNode& node = graph_.nodes()[index];
  const double start_s = Now();
  const StageRecord* valid = ValidRecord(index);
  const bool published = node.publishes.empty() ||
                         (valid && valid->declared == node.publishes && IsPublished(*valid, root_));
  const bool kept = !schedule_.anew[index] && (published || node.publish) &&
                    HasArtefact(ProductPath(index), *schedule_.keys[index]) &&
                    (!node.is_whole || IsWhole(index, context));
  if (!kept) return std::nullopt;
  StageRecord record = valid ? *valid : StageRecord{};
  if (node.publishes.empty()) record.published.clear();
  record.name = node.name;
  record.key = *schedule_.keys[index];
  record.declared = node.publishes;
  record.reused = true;
  std::error_code ignored;  // what cannot be touched is only forgotten earlier
  fs::last_write_time(ProductPath(index), fs::file_time_type::clock::now(), ignored);
  if (!published) record.published = Publish(index, context);
  if (!valid) {
    if (node.report) record.report = node.report(Get(index), InputsOf(index));
    record.seconds = Now() - start_s;
    record.peak_rss_mb = ResidentMegabytes();
  }
  return record;
}

void StageRunner::FinishFirstUnderWay() {
  UnderWay first = std::move(under_way_.front());
  under_way_.erase(under_way_.begin());
  Record(first.index, first.made.get());
}

void StageRunner::Record(std::size_t index, MadeStage made) {
  const StageNode& node = graph_.nodes()[index];
  products_[index] = std::move(made.product);
  StageRecord record{.name = node.name,
                     .key = *schedule_.keys[index],
                     .seconds = made.seconds,
                     .peak_rss_mb = made.peak_rss_mb,
                     .published = std::move(made.published),
                     .declared = node.publishes};
  if (node.report) record.report = node.report(products_[index], InputsOf(index));
  Put(index, std::move(record));
}

bool StageRunner::IsWhole(std::size_t index, const StageContext& context) {
  const StageNode& node = graph_.nodes()[index];
  std::any product = node.load(ProductPath(index), *schedule_.keys[index]);
  if (!product.has_value() || !node.is_whole(context, product)) return false;
  products_[index] = std::move(product);
  return true;
}

MadeStage StageRunner::Make(std::size_t index, const StageContext& context,
                            const StageNode::Inputs& inputs) const {
  return MakeStage(graph_.nodes()[index], *schedule_.keys[index], context, inputs, files_);
}

std::vector<std::string> StageRunner::Publish(std::size_t index, const StageContext& context) {
  const StageNode& node = graph_.nodes()[index];
  Publication publication(root_, node.publishes);
  const std::any product = Get(index);
  try {
    node.publish(publication, context, product, InputsOf(index));
  } catch (...) {
    files_.Discard(node);
    throw;
  }
  return {publication.written().begin(), publication.written().end()};
}

const std::any& StageRunner::Get(std::size_t index) {
  std::any& product = products_[index];
  if (product.has_value()) return product;
  const StageNode& node = graph_.nodes()[index];
  if (node.kind == Kind::kSource) {
    product = node.open().second;
  } else if (node.kind == Kind::kView) {
    product = node.make(ContextOf(index), InputsOf(index));
  } else if (node.kind == Kind::kCheck) {
    product = StageGraph::Pack(ledger_.Find(node.name)->report);
  } else {
    product = node.load(ProductPath(index), *schedule_.keys[index]);
    if (!product.has_value()) {  // damaged inside, which only reading it whole showed
      MadeStage made = Make(index, ContextOf(index), InputsOf(index));
      product = std::move(made.product);
      if (const StageRecord* valid = ValidRecord(index)) {
        StageRecord record = *valid;
        record.published = std::move(made.published);
        record.reused = false;
        Put(index, std::move(record));
      }
    }
  }
  return product;
}

StageNode::Inputs StageRunner::InputsOf(std::size_t index) {
  StageNode::Inputs inputs;
  for (const std::size_t input : graph_.nodes()[index].inputs) inputs.push_back(Get(input));
  return inputs;
}

void StageRunner::Release(const std::vector<std::size_t>& left) {
  std::vector<bool> needed(products_.size(), false);
  const auto need = [&](std::size_t index) {
    for (const std::size_t input : graph_.Needs(index)) needed[input] = true;
  };
  std::ranges::for_each(left, need);
  for (const UnderWay& stage : under_way_) need(stage.index);
  for (std::size_t i = 0; i < products_.size(); ++i) {
    if (!needed[i] && graph_.nodes()[i].kind != Kind::kSource) products_[i].reset();
  }
}

const StageRecord* StageRunner::ValidRecord(std::size_t index) const {
  const StageRecord* record = ledger_.Find(graph_.nodes()[index].name);
  return record && record->key == schedule_.keys[index] ? record : nullptr;
}

fs::path StageRunner::ProductPath(std::size_t index) const {
  return files_.Product(graph_.nodes()[index].name, *schedule_.keys[index]);
}

StageContext StageRunner::ContextOf(std::size_t index) const {
  const std::string& name = graph_.nodes()[index].name;
  const Job* job = Job::Current();
  return {.root = root_,
          .log = files_.Log(name),
          .scratch = files_.Scratch(name),
          .threads = job ? job->threads() : 1,
          .memory_mb = plan_.memory_mb,
          .may_reuse = plan_.take_up_frames && !schedule_.anew[index],
          .publication = nullptr};
}

void StageRunner::Put(std::size_t index, StageRecord record) {
  ledger_.Put(std::move(record));
  std::ranges::stable_sort(ledger_.stages, {},
                           [&](const StageRecord& kept) { return graph_.IndexOf(kept.name); });
  if (graph_.nodes()[index].kind != Kind::kSource) WriteLedger(ledger_, root_);
}

}  // namespace rigmap
