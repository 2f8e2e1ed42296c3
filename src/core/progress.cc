#include "core/progress.h"

#include <unistd.h>

#include <algorithm>

#include "core/console.h"
#include "core/job.h"

namespace rigmap {
namespace {

constexpr auto kBarInterval = std::chrono::milliseconds(100);
constexpr auto kLineInterval = std::chrono::seconds(5);
constexpr std::size_t kBarWidth = 30;

// ", 3.2/s, 14 s left"; nothing before anything is known of the rate.
std::string RateText(std::size_t done, std::size_t total, double seconds) {
  if (done == 0 || !(seconds > 0.5)) return "";
  const double rate = static_cast<double>(done) / seconds;
  if (done == total) return fmt::format(", {:.3g}/s", rate);
  return fmt::format(", {:.3g}/s, {:.0f} s left", rate, static_cast<double>(total - done) / rate);
}

}  // namespace

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      shown_(start_) {}

Progress::~Progress() { Show(true); }

void Progress::Advance(std::size_t steps) {
  const std::lock_guard lock(mutex_);
  done_ += steps;
  Show(false);
}

void Progress::Set(std::size_t done) {
  const std::lock_guard lock(mutex_);
  done_ = done;
  Show(false);
}

void Progress::Show(bool final) {
  const Job* job = Job::Current();
  if (job && job->quiet()) return;
  static const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto now = std::chrono::steady_clock::now();
  if (!final && now - shown_ < (terminal ? std::chrono::nanoseconds(kBarInterval)
                                         : std::chrono::nanoseconds(kLineInterval))) {
    return;
  }
  shown_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const auto done = std::min(done_, total_);
  if (terminal) {
    const std::size_t filled = total_ ? kBarWidth * done / total_ : kBarWidth;
    Say("\r{:<12} [{}{}] {}/{} {:.1f} s{}\x1b[K{}", label_, std::string(filled, '#'),
        std::string(kBarWidth - filled, ' '), done, total_, seconds,
        RateText(done, total_, seconds), final ? "\n" : "");
  } else {
    Say("{}: {}/{} ({:.1f} s{})\n", label_, done, total_, seconds, RateText(done, total_, seconds));
  }
}

}  // namespace rigmap
