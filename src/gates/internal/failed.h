// The gates that a part has failed, as its causes are told from them.
#pragma once

#include <string>
#include <string_view>

#include "gates/refusal.h"

namespace rigmap {

// Holds on to the findings.
class Failed {
 public:
  Failed(const Gates& gates, const PartFindings& findings, int first_frame);

  const Gates& gates() const { return gates_; }
  const PartFindings& findings() const { return findings_; }
  const Gate* Find(std::string_view name) const;
  // "3:9", as the whole data set numbers its frames.
  std::string Frames(const FrameRun& range) const;
  std::string FrameText(int frame) const;
  // Some but not all frames hold together.
  bool IsInPieces() const;

 private:
  Gates gates_;
  const PartFindings& findings_;
  int first_frame_;
};

// How a value and its limit are written, times a factor: 100 for per cent of a share.
std::string ValueText(const Gate& gate, double factor = 1.0);
std::string LimitText(const Gate& gate, double factor = 1.0);

}  // namespace rigmap
