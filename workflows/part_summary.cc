#include "workflows/part_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

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

// How the rig was corrected: the turn of the right eye about its own axes, the focal lengths'
// change.
Json RigJson(const std::optional<std::pair<StereoRig, StereoRig>>& rigs) {
  Json json = {
      {"refined", nullptr}, {"right_eye_turned_deg", nullptr}, {"focal_changed_pct", nullptr}};
  if (!rigs) return json;
  const auto& [calibrated, used] = *rigs;
  const Eigen::Vector3d turn_deg =
      180.0 / std::numbers::pi *
      LogRotation(used.right_from_left.rotation * calibrated.right_from_left.rotation.conjugate());
  const double focal_pct = 100.0 * (used.left.camera.fx / calibrated.left.camera.fx - 1.0);
  json["refined"] = !turn_deg.isZero() || focal_pct != 0.0;
  json["right_eye_turned_deg"] = {turn_deg.x(), turn_deg.y(), turn_deg.z()};
  json["focal_changed_pct"] = focal_pct;
  return json;
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

void PartSummary::SetRevisits(const std::vector<Revisit>& revisits) {
  revisits_ = static_cast<int>(revisits.size());
  revisits_by_appearance_ = static_cast<int>(
      std::ranges::count_if(revisits, [](const Revisit& r) { return r.by_appearance; }));
}

void PartSummary::SetMapping(const MappingResult& mapped) {
  method_ = mapped.method ? NameOf(*mapped.method) : "none";
  AddRemarks(mapped.remarks);
}

void PartSummary::AddRemarks(const std::vector<std::string>& remarks) {
  remarks_.insert(remarks_.end(), remarks.begin(), remarks.end());
}

void PartSummary::SetScale(const PlacedKeyframes& placed) {
  placed_ = placed;
  registered_ =
      static_cast<int>(std::count_if(placed.world_from_left.begin(), placed.world_from_left.end(),
                                     [](const auto& pose) { return pose.has_value(); }));
}

void PartSummary::SetRig(const StereoRig& calibrated, const StereoRig& used) {
  rigs_ = {calibrated, used};
}

void PartSummary::SetTrajectory(const Trajectory& trajectory, WorldUp world_up) {
  posed_ = static_cast<int>(trajectory.size());
  const auto predicted = std::ranges::count(trajectory, PoseSource::kPredicted, &TimedPose::source);
  if (predicted > 0) {
    AddRemarks(
        {fmt::format("{} of {} poses are predicted, since nothing measured their frames: "
                     "their sigmas say how far to trust them",
                     predicted, trajectory.size())});
  }
  world_up_ = Name(world_up);
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
  summary["revisits"] = {{"pairs", OrNull(revisits_)},
                         {"by_appearance", OrNull(revisits_by_appearance_)}};
  if (health_) {
    summary["health"] = {{"lone_images", health_->lone_images},
                         {"unreadable_images", health_->unreadable_images},
                         {"remarks", health_->remarks}};
  }
  summary["mapping"] = {{"method", TextOrNull(method_)}, {"remarks", remarks_}};
  summary["scale"] = ScaleJson(placed_);
  summary["rig"] = RigJson(rigs_);
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
