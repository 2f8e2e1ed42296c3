#include "gates/internal/failed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigmap {

Failed::Failed(const Gates& gates, const PartFindings& findings, int first_frame)
    : findings_(findings), first_frame_(first_frame) {
  for (Gate gate : gates) {
    if (gate.passed) continue;
    // As it is once it was kept and read back: JSON has no other numbers.
    if (gate.value && !std::isfinite(*gate.value)) gate.value.reset();
    gates_.push_back(std::move(gate));
  }
}

const Gate* Failed::Find(std::string_view name) const {
  const auto found = std::ranges::find(gates_, name, &Gate::name);
  return found == gates_.end() ? nullptr : &*found;
}

std::string Failed::Frames(const FrameRun& range) const {
  return fmt::format("{}:{}", first_frame_ + range.first, first_frame_ + range.end);
}

std::string Failed::FrameText(int frame) const { return std::to_string(first_frame_ + frame); }

bool Failed::IsInPieces() const {
  return !findings_.pieces.empty() && findings_.pieces.front().Count() < findings_.frames;
}

std::string ValueText(const Gate& gate, double factor) {
  if (!gate.value) return "an unknown number of";
  // As many digits as tell it from the limit.
  constexpr int kFew = 2, kMany = 6;
  std::string text;
  for (int digits = kFew; digits <= kMany; ++digits) {
    text = fmt::format("{:.{}g}", factor * *gate.value, digits);
    if (text != LimitText(gate, factor)) break;
  }
  return text;
}

std::string LimitText(const Gate& gate, double factor) {
  return fmt::format("{:.4g}", factor * gate.limit);
}

}  // namespace rigmap
