#include "simulation/internal/fault_request.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>

namespace rigmap {
namespace {

template <class Number>
std::optional<Number> Parse(std::string_view text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

UsageError Complaint(const FaultRequest& request, const std::string& expected) {
  return UsageError(fmt::format("--fault {}: expected {}", request.spec, expected));
}

int ParseCount(const FaultRequest& request) {
  const auto count = Parse<int>(request.value);
  if (!count || *count < 0) {
    throw Complaint(
        request, fmt::format("a count or a range of frames FIRST:END, found '{}'", request.value));
  }
  return *count;
}

double ParseShare(const FaultRequest& request) {
  const auto share = Parse<double>(request.value);
  if (!share || !(*share >= 0.0 && *share <= 1.0)) {
    throw Complaint(request, fmt::format("a share from 0 to 1, found '{}'", request.value));
  }
  return *share;
}

FrameRange ParseRange(const FaultRequest& request, int frames) {
  const std::string_view value = request.value;
  const auto colon = value.find(':');
  const auto first = Parse<int>(value.substr(0, colon));
  const auto end = Parse<int>(value.substr(colon + 1));
  if (!first || !end || *first < 0 || *first >= *end || *end > frames) {
    throw Complaint(request, fmt::format("a range FIRST:END within the frames 0:{}, found '{}'",
                                         frames, value));
  }
  return {*first, *end};
}

}  // namespace rigmap
