// Progress on stderr: a bar on a terminal, plain lines elsewhere, nothing in a quiet job.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace rigmap {

// Counts `total` steps of one stage. Advance may be called from several threads.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Advance(std::size_t steps = 1);
  void Set(std::size_t done);

 private:
  void Show(bool final);

  std::mutex mutex_;
  std::string label_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace rigmap
