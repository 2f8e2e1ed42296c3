#include "simulation/internal/fault_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigmap {
namespace {

constexpr int kUntouchedFrames = 2;  // at either end

int Below(HashSequence& random, int end) { return static_cast<int>(random.Unit() * end); }

std::vector<int> Numbers(int first, int count) {
  std::vector<int> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

// As many different ones of `candidates` as the request counts, rising.
std::vector<int> ChooseFrom(FaultRequest& request, std::vector<int> candidates) {
  const int count = ParseCount(request);
  if (count > std::ssize(candidates)) {
    throw Complaint(request,
                    fmt::format("at most {}, which is how many frames are left for it, found {}",
                                candidates.size(), count));
  }
  for (int i = 0; i < count; ++i) {
    const int rest = static_cast<int>(candidates.size()) - i;
    std::swap(candidates[i], candidates[i + Below(request.random, rest)]);
  }
  candidates.resize(static_cast<std::size_t>(count));
  std::ranges::sort(candidates);
  return candidates;
}

}  // namespace

FaultFrames::FaultFrames(int frames)
    : frames_(frames),
      open_frames_(std::max(frames - 2 * kUntouchedFrames, 0)),
      lost_to_(static_cast<std::size_t>(frames)) {}

std::vector<int> FaultFrames::Open() const { return Numbers(kUntouchedFrames, open_frames_); }

std::vector<int> FaultFrames::Untaken() const {
  std::vector<int> untaken = Open();
  std::erase_if(untaken, [&](int i) { return !lost_to_[i].empty(); });
  return untaken;
}

std::vector<int> FaultFrames::Take(const FaultRequest& request, const std::vector<int>& frames) {
  for (const int i : frames) {
    if (!lost_to_[i].empty() && lost_to_[i] != request.name) {
      throw Complaint(
          request, fmt::format("frames that keep their images, but frame {} is given to '{}' too",
                               i, lost_to_[i]));
    }
    lost_to_[i] = request.name;
  }
  return frames;
}

std::vector<int> FaultFrames::TakeRange(const FaultRequest& request) {
  const FrameRange range = ParseRange(request, frames_);
  return Take(request, Numbers(range.first, range.end - range.first));
}

std::vector<int> FaultFrames::TakeSingles(FaultRequest& request) {
  return request.IsRange() ? TakeRange(request) : Take(request, ChooseFrom(request, Untaken()));
}

std::vector<int> FaultFrames::TakeRun(FaultRequest& request) {
  if (request.IsRange()) return TakeRange(request);
  const int count = ParseCount(request);
  if (count == 0) return {};
  const std::vector<int> untaken = Untaken();
  std::vector<int> starts;
  for (int k = 0; count <= std::ssize(untaken) - k; ++k) {
    if (untaken[k + count - 1] - untaken[k] == count - 1) starts.push_back(untaken[k]);
  }
  if (starts.empty()) {
    throw Complaint(request, fmt::format("a count for which there is room between the other faults "
                                         "of {} frames, found {}",
                                         frames_, count));
  }
  const int first = starts[Below(request.random, static_cast<int>(starts.size()))];
  return Take(request, Numbers(first, count));
}

std::vector<int> FaultFrames::Choose(FaultRequest& request) const {
  return ChooseFrom(request, Open());
}

std::vector<FrameRange> FaultFrames::Spread(FaultRequest& request, double mean_frames) const {
  if (request.IsRange()) return {ParseRange(request, frames_)};
  const int count = ParseCount(request);
  if (count == 0) return {};
  const double longest = std::max(open_frames_, 1);
  const int length = static_cast<int>(std::lround(std::clamp(mean_frames, 1.0, longest)));
  if (count > open_frames_ / length) {
    throw Complaint(request, fmt::format("at most {} of {} frames each in {} frames, found {}",
                                         open_frames_ / length, length, frames_, count));
  }
  std::vector<FrameRange> stretches;
  for (int i = 0; i < count; ++i) {
    const int begin = open_frames_ * i / count, end = open_frames_ * (i + 1) / count;
    const int first = kUntouchedFrames + begin + Below(request.random, end - begin - length + 1);
    stretches.push_back({first, first + length});
  }
  return stretches;
}

}  // namespace rigmap
