// The largest resident memory of this process over a stretch of time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace rigmap {

double ResidentMegabytes();  // of this process, now

// Samples from construction on, 50 times a second, in a thread of its own. The kernel's own mark is
// left alone, so that outside tools see the whole run's peak.
class MemoryPeak {
 public:
  MemoryPeak();
  ~MemoryPeak();
  MemoryPeak(const MemoryPeak&) = delete;
  MemoryPeak& operator=(const MemoryPeak&) = delete;

  double Megabytes();  // so far

 private:
  void Sample();

  std::atomic<double> peak_mb_ = 0.0;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread sampler_;
};

// The largest child process that ended in the calling thread, megabytes. The kernel keeps that of
// all a process has had: of a later, smaller one it says nothing.
void CountChild(double peak_mb);
double TakeLargestChild();  // and begins anew; 0: there was none

}  // namespace rigmap
