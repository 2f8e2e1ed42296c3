// Time stamps: int64 nanoseconds since the Unix epoch, UTC.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rigmap {

using StampNs = std::int64_t;

// Seconds with nine decimals, exact: 1448551416619000000 -> "1448551416.619000000".
std::string FormatSeconds(StampNs stamp_ns);

// The inverse, for any decimal number of seconds, also in exponent form as numpy writes it;
// decimals beyond nanoseconds are rounded. Throws DataError on anything else.
StampNs ParseSeconds(std::string_view text);

// Katwijk's YYYY_MM_DD_HH_MM_SS_mmm, UTC. The last field is an integer count of milliseconds, not
// zero padded, and may be 1000 (the next second): "..._36_5" is 36.005 s. Throws DataError.
StampNs ParseKatwijkStamp(std::string_view text);

// The inverse, in the data set's own unpadded form.
std::string FormatKatwijkStamp(StampNs stamp_ns);

}  // namespace rigmap
