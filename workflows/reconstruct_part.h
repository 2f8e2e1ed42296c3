// One part of a traverse: from its stereo frames to whatever the technique makes of them.
#pragma once

#include <exception>
#include <string>

#include "gates/refusal.h"
#include "workflows/part_request.h"

namespace rigmap {

// What an output folder is worth, as summary.json says it.
enum class PartStatus {
  kOk,         // gates were asked, and none failed
  kPartial,    // no gate was asked yet
  kUntrusted,  // a gate failed
  kFailed      // the run ended with an error
};
constexpr auto NamesOf(PartStatus) { return std::array{"ok", "partial", "untrusted", "failed"}; }

struct PartResult {
  PartStatus status = PartStatus::kOk;
  std::string reason;      // why it is not to be trusted, or what is not known
  std::string verdict;     // how good it is, in a sentence; empty where no gate was asked
  Refusal refusal;         // why it is not to be trusted, for people; without causes if it is
  bool summarised = true;  // false: a summary.json in the folder is of an earlier run
};

// Why something could not be done, one line, whoever threw it: of a file that cannot be used with
// its path.
std::string ReasonOf(const std::exception& error);

// Does what is missing in request.out, so that it holds everything of the contract
// (docs/outputs.md) up to the stage asked for. Two parts may be done at once in one process, in
// folders of their own. Throws Error when a part cannot be done; summary.json then says so too, if
// the folder could be claimed. Before anything is written it throws UsageError where the images are
// too large for --memory whatever they show.
PartResult ReconstructPart(const PartRequest& request);

}  // namespace rigmap
