#include "dataset/internal/text_row.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr double kMinEasting_m = 1.0e5, kMaxEasting_m = 9.0e5, kMaxNorthing_m = 1.0e7;

bool IsEasting(double metres) { return metres >= kMinEasting_m && metres <= kMaxEasting_m; }
bool IsNorthing(double metres) { return metres > kMaxEasting_m && metres <= kMaxNorthing_m; }

}  // namespace

std::string_view NextWord(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const auto word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> ParseFinite(std::string_view word) {
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  const bool whole = !word.empty() && result.ec == std::errc() && result.ptr == end;
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<StampNs> ParseStamp(std::string_view word) {
  try {
    return ParseKatwijkStamp(word);
  } catch (const DataError&) {
    return std::nullopt;
  }
}

std::optional<GridColumns> GridColumnsOf(double first, double second) {
  if (IsEasting(first) && IsNorthing(second)) return GridColumns::kEastingFirst;
  if (IsNorthing(first) && IsEasting(second)) return GridColumns::kNorthingFirst;
  return std::nullopt;
}

}  // namespace rigmap
