#include "pipeline/stage_runner.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include "core/freed_memory.h"
#include "core/memory_peak.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using Kind = StageNode::Kind;

constexpr std::size_t kKeptProducts = 2;  // of each stage: this recipe's, and another's

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Largest child so far, of all stages.
double ChildrenPeakMb() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

StageRunner::StageRunner(const StageGraph& graph, fs::path root, RunPlan plan)
    : graph_(graph),
      root_(std::move(root)),
      plan_(std::move(plan)),
      ledger_(ReadLedger(root_)),
      schedule_(MakeSchedule(graph_, plan_, ledger_)),
      outdated_(FindOutdated(graph_, schedule_, ledger_, plan_.known_outputs, root_)),
      products_(std::move(schedule_.sources)) {}

void StageRunner::Clear() {
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
  for (std::size_t i = 0; i < graph_.nodes().size(); ++i) {
    const StageNode& node = graph_.nodes()[i];
    if (!schedule_.selected[i] || node.kind == Kind::kView) continue;
    if (node.kind != Kind::kSource || node.report) {
      job.LogTo(root_ / "logs" / (node.name + ".log"));
    }
    Do(i);
    Release(i);
  }
  job.LogToTerminal();
}

void StageRunner::Do(std::size_t index) {
  switch (graph_.nodes()[index].kind) {
    case Kind::kSource:
      return DoSource(index);
    case Kind::kCheck:
      return DoCheck(index);
    case Kind::kStage:
      return DoStage(index);
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

void StageRunner::DoStage(std::size_t index) {
  const StageNode& node = graph_.nodes()[index];
  ReturnFreedMemory();
  MemoryPeak memory;
  const double start_s = Now();
  const StageContext context = ContextOf(index);
  const StageRecord* valid = ValidRecord(index);
  const bool published = node.publishes.empty() ||
                         (valid && valid->declared == node.publishes && IsPublished(*valid, root_));
  const bool kept = !schedule_.anew[index] && (published || node.publish) &&
                    HasArtefact(ProductPath(index), *schedule_.keys[index]) &&
                    (!node.is_whole || IsWhole(index, context));
  StageRecord record;
  if (kept && valid) record = *valid;
  if (node.publishes.empty()) record.published.clear();
  record.name = node.name;
  record.key = *schedule_.keys[index];
  record.declared = node.publishes;
  record.reused = kept;
  if (kept) {
    std::error_code ignored;  // what cannot be touched is only forgotten earlier
    fs::last_write_time(ProductPath(index), fs::file_time_type::clock::now(), ignored);
  }
  if (!kept) {
    record.published = Make(index, context);
  } else if (!published) {
    record.published = Publish(index, context);
  }
  if (node.report && !(kept && valid)) record.report = node.report(Get(index), InputsOf(index));
  if (!(kept && valid)) {
    const double children_mb = ChildrenPeakMb();
    // The kernel keeps the largest child of all; one that grew it ran in this stage.
    const double child_mb = children_mb > children_peak_mb_ ? children_mb : 0.0;
    children_peak_mb_ = children_mb;
    record.seconds = Now() - start_s;
    record.peak_rss_mb = std::max(memory.Megabytes(), child_mb);
  }
  spdlog::info("{} {:.3f} s", kept ? "reused," : "done,", Now() - start_s);
  Put(index, std::move(record));
}

bool StageRunner::IsWhole(std::size_t index, const StageContext& context) {
  const StageNode& node = graph_.nodes()[index];
  std::any product = node.load(ProductPath(index), *schedule_.keys[index]);
  if (!product.has_value() || !node.is_whole(context, product)) return false;
  products_[index] = std::move(product);
  return true;
}

std::vector<std::string> StageRunner::Make(std::size_t index, const StageContext& given) {
  const StageNode& node = graph_.nodes()[index];
  const StageNode::Inputs inputs = InputsOf(index);
  Publication publication(root_, node.publishes);
  StageContext context = given;
  context.publication = &publication;
  try {
    products_[index] = node.make(context, inputs);
    if (node.publish) node.publish(publication, context, products_[index], inputs);
    fs::remove_all(context.scratch);
    node.keep(ProductPath(index), *schedule_.keys[index], products_[index]);
  } catch (...) {
    Discard(node);
    throw;
  }
  ForgetOlder(node, ProductPath(index));
  return {publication.written().begin(), publication.written().end()};
}

std::vector<std::string> StageRunner::Publish(std::size_t index, const StageContext& context) {
  const StageNode& node = graph_.nodes()[index];
  Publication publication(root_, node.publishes);
  const std::any product = Get(index);
  try {
    node.publish(publication, context, product, InputsOf(index));
  } catch (...) {
    Discard(node);
    throw;
  }
  return {publication.written().begin(), publication.written().end()};
}

// As far as it can be done: the failure that led here matters more.
void StageRunner::Discard(const StageNode& node) const {
  std::vector<std::string> paths = node.publishes;
  paths.push_back("stages/scratch");
  for (const std::string& path : paths) {
    std::error_code code;
    fs::remove_all(root_ / path, code);
    if (code) spdlog::warn("what is left of {} cannot be removed: {}", node.name, code.message());
  }
}

void StageRunner::ForgetOlder(const StageNode& node, const fs::path& newest) const {
  std::vector<std::pair<fs::file_time_type, fs::path>> others;
  for (const auto& entry : fs::directory_iterator(root_ / "stages")) {
    const std::string name = entry.path().filename().string();
    if (entry.path() != newest && name.starts_with(node.name + "-")) {
      others.emplace_back(entry.last_write_time(), entry.path());
    }
  }
  std::ranges::sort(others, std::greater());
  for (std::size_t i = kKeptProducts - 1; i < others.size(); ++i) fs::remove(others[i].second);
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
      const auto published = Make(index, ContextOf(index));
      if (const StageRecord* valid = ValidRecord(index)) {
        StageRecord record = *valid;
        record.published = published;
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

// What no stage to come takes.
void StageRunner::Release(std::size_t done) {
  for (std::size_t i = 0; i <= done; ++i) {
    const bool given = graph_.nodes()[i].kind == Kind::kSource;
    if (!given && schedule_.last_use[i] <= done) products_[i].reset();
  }
}

const StageRecord* StageRunner::ValidRecord(std::size_t index) const {
  const StageRecord* record = ledger_.Find(graph_.nodes()[index].name);
  return record && record->key == schedule_.keys[index] ? record : nullptr;
}

fs::path StageRunner::ProductPath(std::size_t index) const {
  return root_ / "stages" /
         fmt::format("{}-{}.bin", graph_.nodes()[index].name, *schedule_.keys[index]);
}

StageContext StageRunner::ContextOf(std::size_t index) const {
  const std::string& name = graph_.nodes()[index].name;
  const Job* job = Job::Current();
  return {.root = root_,
          .log = root_ / "logs" / (name + ".log"),
          .scratch = root_ / "stages" / "scratch",
          .threads = job ? job->threads() : 1,
          .memory_mb = plan_.memory_mb,
          .may_reuse = !schedule_.anew[index],
          .publication = nullptr};
}

void StageRunner::Put(std::size_t index, StageRecord record) {
  ledger_.Put(std::move(record));
  std::ranges::stable_sort(ledger_.stages, {},
                           [&](const StageRecord& kept) { return graph_.IndexOf(kept.name); });
  if (graph_.nodes()[index].kind != Kind::kSource) WriteLedger(ledger_, root_);
}

}  // namespace rigmap
