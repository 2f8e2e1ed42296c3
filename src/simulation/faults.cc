#include "simulation/faults.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

#include "simulation/internal/fault_frames.h"
#include "simulation/internal/fault_request.h"

namespace rigmap {
namespace {

constexpr double kMaxExposureGain = 1.6;  // and its inverse: what an automatic exposure does
constexpr double kMinExposureStep = 1.15;
constexpr double kPersonFrames = 12.0;
constexpr double kOutage_s = 10.0, kSlip_s = 3.0;
constexpr std::uint64_t kApart = 0x9E3779B97F4A7C15;  // between the seeds of one name's requests
constexpr double kGlareArea = 0.3;                    // share of the image, as in southbound frames

class Planner {
 public:
  Planner(int frames, double frame_interval_s)
      : frames_(frames), frame_interval_s_(frame_interval_s), fault_frames_(frames) {
    plan_.frames.resize(static_cast<std::size_t>(frames));
  }

  FaultPlan plan() const { return plan_; }

  void Dropped(FaultRequest& request) {
    for (const int i : fault_frames_.TakeRun(request)) At(i).dropped = true;
  }
  void LoneLeft(FaultRequest& request) {
    for (const int i : fault_frames_.TakeRun(request)) At(i).lone = Eye::kLeft;
  }
  void LoneRight(FaultRequest& request) {
    for (const int i : fault_frames_.TakeRun(request)) At(i).lone = Eye::kRight;
  }
  void Black(FaultRequest& request) {
    for (const int i : fault_frames_.TakeSingles(request)) At(i).black = true;
  }
  void Truncated(FaultRequest& request) {
    for (const int i : fault_frames_.TakeSingles(request))
      At(i).truncated = kEyes[request.random.Unit() < 0.5 ? 0 : 1];
  }

  void Exposure(FaultRequest& request) {
    if (request.IsRange()) {
      const FrameRange range = ParseRange(request, frames_);
      const double gain = NextGain(request.random, 1.0);
      for (int i = range.first; i < range.end; ++i) At(i).exposure_gain = gain;
      return;
    }
    std::vector<int> starts = fault_frames_.Choose(request);
    starts.push_back(frames_);
    double gain = 1.0;
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
      gain = NextGain(request.random, gain);
      for (int i = starts[k]; i < starts[k + 1]; ++i) At(i).exposure_gain = gain;
    }
  }

  void Shadow(FaultRequest& request) {
    FrameRange range{0, frames_};
    if (request.IsRange()) {
      range = ParseRange(request, frames_);
    } else if (const int count = ParseCount(request); count > 1) {
      throw Complaint(request, "1 for the whole run, 0 for none, or a range FIRST:END");
    } else if (count == 0) {
      range.end = 0;
    }
    for (int i = range.first; i < range.end; ++i) At(i).shadow = true;
  }

  void Person(FaultRequest& request) {
    Add(plan_.persons, fault_frames_.Spread(request, kPersonFrames));
  }
  void GpsOutage(FaultRequest& request) {
    Add(plan_.gps_outages, fault_frames_.Spread(request, kOutage_s / frame_interval_s_));
  }
  void Slip(FaultRequest& request) {
    Add(plan_.slip_bursts, fault_frames_.Spread(request, kSlip_s / frame_interval_s_));
  }

  void GlareArea(FaultRequest& request) {
    glare_area_ = ParseShare(request);
    if (glare_area_ == 0.0) throw Complaint(request, "a share over 0");
  }
  void Glare(FaultRequest& request) {
    FrameRange range;
    if (request.IsRange()) {
      range = ParseRange(request, frames_);
    } else {
      const int length = static_cast<int>(std::lround(ParseShare(request) * frames_));
      range.first = (frames_ - length) / 2;
      range.end = range.first + length;
    }
    for (int i = range.first; i < range.end; ++i) At(i).glare_area = glare_area_;
  }

 private:
  FrameFault& At(int frame) { return plan_.frames[static_cast<std::size_t>(frame)]; }

  static void Add(std::vector<FrameRange>& to, const std::vector<FrameRange>& ranges) {
    to.insert(to.end(), ranges.begin(), ranges.end());
    std::ranges::sort(to, {}, &FrameRange::first);
  }

  static double NextGain(HashSequence& random, double previous) {
    const double reach = std::log(kMaxExposureGain);
    double gain = previous;
    while (std::abs(std::log(gain / previous)) < std::log(kMinExposureStep)) {
      gain = std::exp(random.Between(-reach, reach));
    }
    return gain;
  }

  int frames_;
  double frame_interval_s_;
  double glare_area_ = kGlareArea;
  FaultFrames fault_frames_;
  FaultPlan plan_;
};

// In this order: glare needs to know its area; images taken at given places leave the others the
// rest; runs need room.
enum class Turn { kArea, kRanges, kRuns, kSingles, kOthers };
constexpr std::size_t kTurns = 5;

struct FaultName {
  std::string_view name;
  void (Planner::*plan)(FaultRequest&);
  Turn turn;  // of a count
  const char* help;
};

constexpr std::array<FaultName, 12> kFaultNames{{
    {"dropped", &Planner::Dropped, Turn::kRuns,
     "N consecutive frames of which neither image is there"},
    {"lone-left", &Planner::LoneLeft, Turn::kRuns, "N consecutive frames with the left image only"},
    {"lone-right", &Planner::LoneRight, Turn::kRuns,
     "N consecutive frames with the right image only"},
    {"black", &Planner::Black, Turn::kSingles, "N frames with black images"},
    {"truncated", &Planner::Truncated, Turn::kSingles, "N frames of which one file ends early"},
    {"exposure", &Planner::Exposure, Turn::kOthers, "N steps of exposure by up to a factor of 1.6"},
    {"shadow", &Planner::Shadow, Turn::kOthers,
     "1: the rover's shadow and a wheel in view throughout"},
    {"person", &Planner::Person, Turn::kOthers, "N people walk through, each for about 12 frames"},
    {"gps-outage", &Planner::GpsOutage, Turn::kOthers, "N times about 10 s without fixes"},
    {"slip", &Planner::Slip, Turn::kOthers, "N times about 3 s in which the wheels slip"},
    {"glare", &Planner::Glare, Turn::kOthers,
     "share of the frames, 0 to 1, in the middle of the run"},
    {"glare-area", &Planner::GlareArea, Turn::kArea,
     "share of the image that glare saturates (0.3)"},
}};

const FaultName& FaultNameOf(const std::string& spec) {
  const std::string name = spec.substr(0, spec.find('='));
  const auto known = std::ranges::find(kFaultNames, name, &FaultName::name);
  if (known != kFaultNames.end()) return *known;
  std::vector<std::string_view> names;
  for (const FaultName& fault : kFaultNames) names.push_back(fault.name);
  throw UsageError(
      fmt::format("--fault {}: expected NAME=VALUE with one of the names {}, found '{}'", spec,
                  fmt::join(names, ", "), name));
}

FaultRequest ParseSpec(const std::string& spec, std::size_t index, std::uint64_t seed) {
  const auto equals = spec.find('=');
  const std::string value = equals == std::string::npos ? "" : spec.substr(equals + 1);
  return {spec, spec.substr(0, equals), value,
          HashSequence(seed, static_cast<std::uint32_t>(index) + 1)};
}

}  // namespace

FaultPlan PlanFaults(std::span<const std::string> specs, int frames, std::uint64_t seed,
                     double frame_interval_s) {
  Planner planner(frames, frame_interval_s);
  std::array<std::vector<FaultRequest>, kTurns> turns;
  std::array<std::uint64_t, kFaultNames.size()> times_given{};
  for (const std::string& spec : specs) {
    const FaultName& fault = FaultNameOf(spec);
    const auto index = static_cast<std::size_t>(&fault - kFaultNames.data());
    const FaultRequest request = ParseSpec(spec, index, seed + kApart * times_given[index]++);
    const bool takes_images = fault.turn == Turn::kRuns || fault.turn == Turn::kSingles;
    const Turn turn = takes_images && request.IsRange() ? Turn::kRanges : fault.turn;
    turns[static_cast<std::size_t>(turn)].push_back(request);
  }
  // The longest first, while there is room.
  std::ranges::stable_sort(turns[static_cast<std::size_t>(Turn::kRuns)], std::greater<>(),
                           ParseCount);
  for (auto& turn : turns) {
    for (FaultRequest& request : turn) (planner.*FaultNameOf(request.spec).plan)(request);
  }
  FaultPlan plan = planner.plan();
  if (frames > 0 && std::ranges::all_of(plan.frames, &FrameFault::dropped)) {
    throw UsageError(fmt::format(
        "--fault dropped: expected at least one frame to be left, found all {} dropped", frames));
  }
  return plan;
}

std::string DescribeFaultNames() {
  std::string text;
  for (const FaultName& known : kFaultNames) {
    text += fmt::format("  {:<12} {}\n", known.name, known.help);
  }
  return text +
         "A range of frame indices FIRST:END may stand in place of N, and of glare's share.\n";
}

}  // namespace rigmap
