// summary.json: what was done, how well, and whether to trust it.
#pragma once

#include <string>
#include <vector>

#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/gate.h"
#include "scene/mapping_result.h"
#include "scene/placed_keyframes.h"
#include "scene/trajectory.h"
#include "scene/world_up.h"
#include "workflows/reconstruct_part.h"
#include "workflows/stage_runner.h"

namespace rigmap {

// Filled as the stages end; what has not been reached stays null in the file.
class PartSummary {
 public:
  explicit PartSummary(const PartRequest& request) : request_(request) {}

  void SetDataset(const Dataset& dataset);
  // Images that only reading them whole showed to be damaged may be among them.
  void AddUnreadableImages(const std::vector<std::string>& paths);
  void SetKeyframes(int keyframes) { keyframes_ = keyframes; }
  void SetRevisits(const std::vector<Revisit>& revisits);
  void SetMapping(const MappingResult& mapped);
  void AddRemarks(const std::vector<std::string>& remarks);
  void SetScale(const PlacedKeyframes& placed);
  void SetTrajectory(const Trajectory& trajectory, WorldUp world_up);
  void SetRig(const StereoRig& calibrated, const StereoRig& used);
  void AddGates(const Gates& gates) { gates_.insert(gates_.end(), gates.begin(), gates.end()); }
  void SetColmapVersion(const std::string& version) { colmap_version_ = version; }
  void Fail(const std::string& reason) { failure_ = reason; }

  // Writes summary.json and config.yaml, and says how the run ended.
  PartResult Write(const StageRunner& run) const;

 private:
  const PartRequest& request_;
  std::optional<DatasetHealth> health_;
  std::optional<int> paired_, keyframes_, registered_, posed_;
  std::optional<int> revisits_, revisits_by_appearance_;
  std::vector<std::string> remarks_;
  std::string method_, world_up_, failure_, colmap_version_;
  std::optional<PlacedKeyframes> placed_;
  std::optional<std::pair<StereoRig, StereoRig>> rigs_;  // as calibrated, as used
  Gates gates_;
};

}  // namespace rigmap
