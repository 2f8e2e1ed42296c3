#include "gates/internal/failed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigmap {
namespace {

// The part that a frame of the whole belongs to, and its number there.
std::pair<const FrameNames::Part*, int> PartWith(const FrameNames& names, int frame) {
  const FrameNames::Part* part = &names.parts.front();
  for (const FrameNames::Part& candidate : names.parts) {
    part = &candidate;
    if (frame < candidate.frames) break;
    if (&candidate != &names.parts.back()) frame -= candidate.frames;
  }
  return {part, part->first + frame};
}

}  // namespace

std::string FrameNames::Of(int frame) const {
  if (parts.empty()) return std::to_string(first + frame);
  const auto [part, number] = PartWith(*this, frame);
  return fmt::format("{} of part {}", number, part->name);
}

std::string FrameNames::Of(const FrameRun& range) const {
  if (parts.empty()) return fmt::format("{}:{}", first + range.first, first + range.end);
  const auto [part, from] = PartWith(*this, range.first);
  const auto [last_part, last] = PartWith(*this, range.end - 1);
  if (part == last_part) return fmt::format("{}:{} of part {}", from, last + 1, part->name);
  return fmt::format("{} to {}", Of(range.first), Of(range.end - 1));
}

Failed::Failed(const Gates& gates, const PartFindings& findings, const FrameNames& names)
    : findings_(findings), names_(names) {
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

std::string_view Failed::ToTakeFrames() const {
  return names_.parts.empty() ? "--frames" : "rigmap part --frames";
}

bool Failed::IsInPieces() const {
  return !findings_.pieces.empty() && findings_.pieces.front().Count() < findings_.frames;
}

namespace {

// Never as a power of ten: people read it.
std::string Plain(double value, int digits) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  return text.find("e+") == std::string::npos ? text : fmt::format("{:.0f}", value);
}

}  // namespace

std::string ValueText(const Gate& gate, double factor) {
  if (!gate.value) return "an unknown number of";
  // As many digits as tell it from the limit.
  constexpr int kFew = 2, kMany = 6;
  std::string text;
  for (int digits = kFew; digits <= kMany; ++digits) {
    text = Plain(factor * *gate.value, digits);
    if (text != LimitText(gate, factor)) break;
  }
  return text;
}

std::string LimitText(const Gate& gate, double factor) {
  constexpr int kDigits = 4;
  return Plain(factor * gate.limit, kDigits);
}

}  // namespace rigmap
