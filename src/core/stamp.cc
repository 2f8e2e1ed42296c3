#include "core/stamp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr StampNs kNsPerSecond = 1'000'000'000;
constexpr StampNs kNsPerMillisecond = 1'000'000;

bool ParseInteger(std::string_view text, std::int64_t& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return !text.empty() && result.ec == std::errc() && result.ptr == end;
}

// "1.4037152732621e+09" -> "1403715273.2621": moves the point in the text, since a double would
// lose the last hundreds of nanoseconds. Returns nothing for what is no such number.
std::optional<std::string> WithoutExponent(std::string_view text) {
  constexpr std::int64_t kMaxExponent = 40;
  const auto mark = text.find_first_of("eE");
  std::string_view mantissa = text.substr(0, mark);
  std::string_view exponent_text = text.substr(mark + 1);
  if (exponent_text.starts_with('+') && !exponent_text.starts_with("+-")) {
    exponent_text.remove_prefix(1);
  }
  std::int64_t exponent = 0;
  if (!ParseInteger(exponent_text, exponent) || std::abs(exponent) > kMaxExponent) return {};
  const bool has_sign = !mantissa.empty() && (mantissa.front() == '-' || mantissa.front() == '+');
  const std::string sign(mantissa.substr(0, has_sign ? 1 : 0));
  mantissa.remove_prefix(has_sign ? 1 : 0);
  const auto point = std::min(mantissa.find('.'), mantissa.size());
  std::string digits(mantissa.substr(0, point));
  if (point < mantissa.size()) digits += mantissa.substr(point + 1);
  if (digits.empty()) return {};
  std::int64_t position = static_cast<std::int64_t>(point) + exponent;
  if (position < 0) digits.insert(0, static_cast<std::size_t>(-position), '0');
  position = std::max<std::int64_t>(position, 0);
  if (position > std::ssize(digits)) digits.resize(static_cast<std::size_t>(position), '0');
  digits.insert(static_cast<std::size_t>(position), 1, '.');
  const auto first = std::min(digits.find_first_not_of('0'), digits.find('.'));
  return sign + digits.substr(first);
}

}  // namespace

std::string FormatSeconds(StampNs stamp_ns) {
  const bool negative = stamp_ns < 0;
  const std::uint64_t ns = negative ? -static_cast<std::uint64_t>(stamp_ns) : stamp_ns;
  return fmt::format("{}{}.{:09}", negative ? "-" : "", ns / kNsPerSecond, ns % kNsPerSecond);
}

StampNs ParseSeconds(std::string_view text) {
  const std::string_view whole_text = text;
  std::string plain;
  if (text.find_first_of("eE") != std::string_view::npos) {
    plain = WithoutExponent(text).value_or("");
    text = plain;
  }
  const bool negative = !text.empty() && text.front() == '-';
  if (negative || (!text.empty() && text.front() == '+')) text.remove_prefix(1);
  const auto point = text.find('.');
  std::string_view whole = text.substr(0, point);
  std::string fraction(point == std::string_view::npos ? "" : text.substr(point + 1));
  const bool digits_only = (whole.find_first_not_of("0123456789") == std::string_view::npos) &&
                           fraction.find_first_not_of("0123456789") == std::string::npos &&
                           !(whole.empty() && fraction.empty());
  std::int64_t seconds = 0;
  if (!digits_only || (!whole.empty() && !ParseInteger(whole, seconds)) ||
      seconds > std::numeric_limits<StampNs>::max() / kNsPerSecond - 1) {
    throw DataError(fmt::format("expected a time in seconds, found '{}'", whole_text));
  }
  const bool round_up = fraction.size() > 9 && fraction[9] >= '5';
  fraction.resize(9, '0');
  std::int64_t ns = 0;
  ParseInteger(fraction, ns);
  const StampNs stamp = seconds * kNsPerSecond + ns + (round_up ? 1 : 0);
  return negative ? -stamp : stamp;
}

StampNs ParseKatwijkStamp(std::string_view text) {
  const auto fail = [&] {
    return DataError(fmt::format("expected a stamp YYYY_MM_DD_HH_MM_SS_mmm, found '{}'", text));
  };
  std::array<std::int64_t, 7> field{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const bool last = i + 1 == field.size();
    const auto end = last ? rest.size() : rest.find('_');
    if (end == std::string_view::npos || !ParseInteger(rest.substr(0, end), field[i])) throw fail();
    if (field[i] < 0) throw fail();
    rest.remove_prefix(last ? end : end + 1);
  }
  using namespace std::chrono;
  const year_month_day date{year(static_cast<int>(field[0])),
                            month(static_cast<unsigned>(field[1])),
                            day(static_cast<unsigned>(field[2]))};
  // The chrono types keep only the low bits: month 267 would be November.
  if (!date.ok() || field[0] < 1970 || field[0] > 2200 || field[1] > 12 || field[2] > 31 ||
      field[3] > 23 || field[4] > 59 || field[5] > 60 || field[6] > 1000) {
    throw fail();
  }
  const StampNs seconds = sys_days(date).time_since_epoch().count() * StampNs{86400} +
                          field[3] * 3600 + field[4] * 60 + field[5];
  return seconds * kNsPerSecond + field[6] * kNsPerMillisecond;
}

std::string FormatKatwijkStamp(StampNs stamp_ns) {
  using namespace std::chrono;
  const sys_time<nanoseconds> time{nanoseconds(stamp_ns)};
  const auto day_start = floor<days>(time);
  const year_month_day date{day_start};
  const hh_mm_ss<milliseconds> clock{floor<milliseconds>(time - day_start)};
  return fmt::format("{:04}_{:02}_{:02}_{:02}_{:02}_{:02}_{}", int(date.year()),
                     unsigned(date.month()), unsigned(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

}  // namespace rigmap
