// The gates that a part has failed, as its causes are told from them.
#pragma once

#include <string>
#include <string_view>

#include "gates/refusal.h"

namespace rigmap {

// Holds on to the findings and names.
class Failed {
 public:
  Failed(const Gates& gates, const PartFindings& findings, const FrameNames& names);

  const Gates& gates() const { return gates_; }
  const PartFindings& findings() const { return findings_; }
  const Gate* Find(std::string_view name) const;
  const FrameNames& names() const { return names_; }
  // What takes a stretch of frames.
  std::string_view ToTakeFrames() const;
  // Some but not all frames hold together.
  bool IsInPieces() const;

 private:
  Gates gates_;
  const PartFindings& findings_;
  const FrameNames& names_;
};

// How a value and its limit are written, times a factor: 100 for per cent of a share.
std::string ValueText(const Gate& gate, double factor = 1.0);
std::string LimitText(const Gate& gate, double factor = 1.0);

}  // namespace rigmap
