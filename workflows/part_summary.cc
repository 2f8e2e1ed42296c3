#include "workflows/part_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json TextOrNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json StagesJson(const StageRunner& run) {
  Json stages = Json::array();
  for (const StageRecord& record : run.records()) {
    stages.push_back({{"name", record.name},
                      {"seconds", record.seconds},
                      {"peak_rss_mb", record.peak_rss_mb},
                      {"reused", record.reused}});
  }
  return stages;
}

// The first model's factor; spread and counts over all models.
Json ScaleJson(const std::optional<PlacedKeyframes>& placed) {
  Json scale = {{"metres_per_model_unit", nullptr},
                {"relative_spread", nullptr},
                {"pairs_used", 0},
                {"pairs_rejected", Json::array()}};
  if (!placed || placed->models.empty()) return scale;
  double spread = 0.0;
  std::size_t used = 0;
  std::vector<int> rejected;
  for (const PlacedModel& model : placed->models) {
    spread = std::max(spread, model.scale.relative_spread);
    used += model.scale.pairs_used.size();
    rejected.insert(rejected.end(), model.scale.pairs_rejected.begin(),
                    model.scale.pairs_rejected.end());
  }
  scale["metres_per_model_unit"] = placed->models.front().scale.metres_per_model_unit;
  scale["relative_spread"] = spread;
  scale["pairs_used"] = used;
  scale["pairs_rejected"] = rejected;
  return scale;
}

Json GatesJson(const Gates& gates) {
  Json list = Json::array();
  for (const Gate& gate : gates) {
    list.push_back({{"name", gate.name},
                    {"value", OrNull(gate.value)},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"why", gate.why}});
  }
  return list;
}

// Paths and other programs' words need not be UTF-8, as JSON must.
std::string AnyText(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

void PartSummary::SetDataset(const Dataset& dataset) {
  health_ = dataset.health;
  paired_ = static_cast<int>(dataset.frames.size());
}

void PartSummary::AddUnreadableImages(const std::vector<std::string>& paths) {
  if (!health_) health_.emplace();
  auto& all = health_->unreadable_images;
  all.insert(all.end(), paths.begin(), paths.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

void PartSummary::SetMapping(const MappingResult& mapped) {
  method_ = mapped.method;
  remarks_ = mapped.remarks;
}

void PartSummary::SetScale(const PlacedKeyframes& placed) {
  placed_ = placed;
  registered_ =
      static_cast<int>(std::count_if(placed.world_from_left.begin(), placed.world_from_left.end(),
                                     [](const auto& pose) { return pose.has_value(); }));
}

void PartSummary::SetTrajectory(const Trajectory& trajectory, const std::string& world_up) {
  posed_ = static_cast<int>(trajectory.size());
  world_up_ = world_up;
}

PartResult PartSummary::Write(const StageRunner& run) const {
  PartResult result;
  result.reason = FailureReason(gates_);
  if (!result.reason.empty()) result.status = PartStatus::kUntrusted;
  const char* status = !failure_.empty()                         ? "failed"
                       : result.status == PartStatus::kUntrusted ? "untrusted"
                                                                 : "ok";
  Json summary = {{"status", status},
                  {"reason", TextOrNull(failure_.empty() ? result.reason : failure_)},
                  {"world_up", TextOrNull(world_up_)},
                  {"stages", StagesJson(run)}};
  summary["frames"] = {{"read", health_ ? Json(health_->images_read) : Json(nullptr)},
                       {"paired", OrNull(paired_)},
                       {"keyframes", OrNull(keyframes_)},
                       {"registered", OrNull(registered_)},
                       {"posed", OrNull(posed_)}};
  if (health_) {
    summary["health"] = {{"lone_images", health_->lone_images},
                         {"unreadable_images", health_->unreadable_images},
                         {"remarks", health_->remarks}};
  }
  summary["mapping"] = {{"method", TextOrNull(method_)}, {"remarks", remarks_}};
  summary["scale"] = ScaleJson(placed_);
  summary["gates"] = GatesJson(gates_);
  summary["versions"] = {{"rigmap", RIGMAP_VERSION}, {"colmap", TextOrNull(colmap_version_)}};
  summary["command"] = request_.command;
  const auto& root = run.layout().root;
  WriteFileAtomically(root / "summary.json",
                      [&](std::ostream& stream) { stream << AnyText(summary) << '\n'; });
  WriteFileAtomically(root / "config.yaml",
                      [&](std::ostream& stream) { stream << WritePartOptions(request_.options); });
  return result;
}

}  // namespace rigmap
