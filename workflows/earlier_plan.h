// What an earlier run of a traverse has left in its folder, against what is asked for now.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace rigmap {

// `plan` as ToJson of a TraversePlan writes it, as does OUT/plan.json. Throws DataError where the
// folder holds parts of other data, or parts that were cut otherwise: known before any work is
// done, each part's folder and the join's say so of their own frames only.
void RequireSamePlan(const std::filesystem::path& out, const nlohmann::ordered_json& plan);

// The parts of the earlier plan that this one has no job for: their folders in OUT/parts, where
// they hold results of rigmap. Throws DataError where a run is at work in one.
void RemovePartsBeside(const std::filesystem::path& out, const nlohmann::ordered_json& plan);

}  // namespace rigmap
