#include "simulation/sensor_clock.h"

namespace rigmap {

std::string FormatKatwijkStampAsRecorded(StampNs stamp_ns) {
  constexpr StampNs kSecondNs = 1'000'000'000;
  std::string text = FormatKatwijkStamp(stamp_ns);
  if (!text.ends_with("_0")) return text;
  text = FormatKatwijkStamp(stamp_ns - kSecondNs);
  return text.substr(0, text.size() - 1) + "1000";
}

}  // namespace rigmap
