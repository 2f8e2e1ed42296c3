#include "core/memory_peak.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <utility>

namespace rigmap {

namespace {

thread_local double largest_child_mb = 0.0;

}  // namespace

double ResidentMegabytes() {
  std::ifstream pages("/proc/self/statm");
  double size = 0.0, resident = 0.0;
  pages >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

void CountChild(double peak_mb) { largest_child_mb = std::max(largest_child_mb, peak_mb); }

double TakeLargestChild() { return std::exchange(largest_child_mb, 0.0); }

MemoryPeak::MemoryPeak() : peak_mb_(ResidentMegabytes()), sampler_([this] { Sample(); }) {}

MemoryPeak::~MemoryPeak() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_one();
  sampler_.join();
}

double MemoryPeak::Megabytes() {
  const double now_mb = ResidentMegabytes();
  double known_mb = peak_mb_;
  while (now_mb > known_mb && !peak_mb_.compare_exchange_weak(known_mb, now_mb)) {
  }
  return peak_mb_;
}

void MemoryPeak::Sample() {
  constexpr auto kInterval = std::chrono::milliseconds(20);
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, kInterval, [this] { return stopping_; })) Megabytes();
}

}  // namespace rigmap
