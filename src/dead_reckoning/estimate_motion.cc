#include "dead_reckoning/estimate_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "dead_reckoning/internal/mean_square.h"
#include "dead_reckoning/internal/measurements.h"
#include "dead_reckoning/internal/required_records.h"

namespace rigmap {
namespace {

double SecondsFrom(StampNs from, StampNs to) { return 1e-9 * static_cast<double>(to - from); }

// Follows the frames of a part from the first to the last.
class Follower {
 public:
  Follower(const Dataset& dataset, std::span<const VisualStep> visual, const RoverModel& model,
           std::span<const int> references)
      : dataset_(dataset),
        model_(model),
        references_(references),
        way_(model.filter.use_wheels ? dataset.wheels : WheelRecord{}, dataset.rig, model.options) {
    if (model.filter.use_gyro) gyro_ = dataset.inertial.samples;
    if (model.filter.use_vision) {
      for (const VisualStep& step : visual) steps_[step.to].push_back(step);
    }
    for (const auto& [to, steps] : steps_) {
      for (const VisualStep& step : steps) {
        KeepUntil(to, step.from);
        ++uses_[step.from];
      }
    }
    for (int i = 0; i < static_cast<int>(references.size()); ++i) {
      if (references[i] < i) KeepUntil(i, references[i]);
    }
    motion_.poses.resize(dataset.frames.size());
  }

  EstimatedMotion Follow() {
    Start();
    for (std::size_t i = 1; i < dataset_.frames.size(); ++i) Next(static_cast<int>(i));
    const std::vector<Belief> smoothed = Smoothed(filtered_, advances_);
    for (std::size_t i = 0; i < smoothed.size(); ++i) {
      motion_.poses[i].gauge_from_left = smoothed[i].rover.gauge_from_left;
      motion_.poses[i].covariance = smoothed[i].covariance.topLeftCorner<6, 6>();
      if (!steps_.empty()) AddVisualScale(motion_.poses[i]);
    }
    for (int i = 0; i < static_cast<int>(references_.size()); ++i) {
      if (references_[i] < i)
        motion_.poses[i].since_reference = CovarianceSince(references_[i], smoothed[i]);
    }
    const Belief& last = smoothed.back();
    motion_.wheel_scale = std::exp(last.rover.values(kWheelScale));
    motion_.wheel_scale_sigma =
        motion_.wheel_scale * std::sqrt(last.covariance(kWheelScale, kWheelScale));
    motion_.agreement = {along_.Value(), aside_.Value(), turn_.Value()};
    motion_.gyro_bias_radps = last.rover.values.segment<3>(kGyroBias);
    return std::move(motion_);
  }

 private:
  StampNs StampOf(int frame) const { return dataset_.frames[frame].stamp_ns; }

  void KeepUntil(int frame, int clone) {
    int& last = last_use_.try_emplace(clone, frame).first->second;
    last = std::max(last, frame);
  }

  void Start() {
    Belief belief;
    const StateVector sigmas = PriorSigmas(model_.options);
    belief.covariance = sigmas.cwiseAbs2().asDiagonal();
    if (!dataset_.inclinometer.empty()) {
      belief.rover.up_in_gauge = model_.imu_from_left.rotation.conjugate() *
                                 dataset_.inclinometer.front().acceleration_in_imu.normalized();
    }
    belief = Levelled(belief, 0);
    const auto& samples = dataset_.wheels.samples;
    if (!samples.empty()) belief = Rested(belief, RestBefore(StampOf(0)), StampOf(0));
    filtered_.push_back(belief);
  }

  // Since when the rover has stood still at a time.
  StampNs RestBefore(StampNs stamp_ns) const {
    StampNs since_ns = stamp_ns;
    const auto& samples = dataset_.wheels.samples;
    for (std::size_t i = samples.size(); i-- > 0;) {
      if (samples[i].stamp_ns >= stamp_ns) continue;
      if (!way_.StandsStill(samples[i].stamp_ns, stamp_ns)) break;
      since_ns = samples[i].stamp_ns;
    }
    return since_ns;
  }

  Belief Rested(const Belief& belief, StampNs begin_ns, StampNs end_ns) const {
    constexpr double kLeastRest_s = 0.5;
    const MeanRate rate = MeanRateBetween(begin_ns, end_ns, gyro_);
    if (rate.duration_s < kLeastRest_s) return belief;
    return Updated(belief, BiasAtRest(belief, rate, model_));
  }

  Belief Levelled(const Belief& belief, int frame) const {
    if (!model_.filter.use_inclinometer) return belief;
    const auto& samples = dataset_.inclinometer;
    const auto sample =
        std::ranges::lower_bound(samples, StampOf(frame), {}, &InclinometerSample::stamp_ns);
    if (sample == samples.end() || sample->stamp_ns != StampOf(frame)) return belief;
    return Updated(belief, InclinationOf(belief, sample->acceleration_in_imu, model_));
  }

  void Next(int frame) {
    const StampNs begin_ns = StampOf(frame - 1), end_ns = StampOf(frame);
    const Belief& before = filtered_.back();
    const SensorSteps steps = CutSteps(begin_ns, end_ns, gyro_, way_, model_.options);
    const Prediction prediction = Predict(before.rover, steps, CarriedTo(frame), model_);
    const std::vector<int> kept = ClonesFor(frame);
    Advance advance = Advanced(before, frame - 1, kept, prediction);
    bool is_seen = false;
    const bool is_driven = std::ranges::all_of(
        steps, [](const SensorStep& step) { return step.way_m && step.turn_rate_radps; });
    Belief belief = advance.predicted;
    for (const VisualStep& step : StepsTo(frame)) {
      if (InnovationAlong(belief, prediction.way_in_gauge, step) > model_.filter.slip_sigmas ||
          InnovationOf(belief, step) > model_.filter.max_innovation_sigmas) {
        // Either the wheels slip or the images mislead: the first, if slip explains it.
        Advance slipping = Advanced(before, frame - 1, kept, WithSlip(prediction));
        if (is_seen ||
            InnovationOf(slipping.predicted, step) > model_.filter.max_innovation_sigmas) {
          motion_.misled.push_back(frame);
          continue;
        }
        motion_.slips.push_back(frame);
        advance = std::move(slipping);
        belief = advance.predicted;
      } else if (!is_seen) {
        NoteAgreement(belief, prediction.way_in_gauge, step);
      }
      belief = Updated(belief, VisualMotionOf(belief, step, NoiseFactor(step)));
      is_seen = true;
    }
    motion_.poses[frame].is_measured = is_seen || is_driven;
    belief = Levelled(belief, frame);
    if (way_.StandsStill(begin_ns, end_ns)) belief = Rested(belief, begin_ns, end_ns);
    carried_ = MotionBetween(before.rover.gauge_from_left, belief.rover.gauge_from_left,
                             SecondsFrom(begin_ns, end_ns));
    advances_.push_back(std::move(advance));
    filtered_.push_back(std::move(belief));
  }

  // As before; but a turn that the images show is taken from them, lest it be far from where errors
  // are linear: what nothing else tells of has a sigma beside which this changes nothing.
  CarriedMotion CarriedTo(int frame) const {
    const std::vector<VisualStep> steps = StepsTo(frame);
    if (steps.empty()) return carried_;
    const Belief& before = filtered_.back();
    const VisualStep& step = steps.front();
    const auto clone = std::ranges::find(before.clones, step.from, &ClonedPose::frame);
    const Rigid3& from =
        clone == before.clones.end() ? before.rover.gauge_from_left : clone->gauge_from_left;
    CarriedMotion carried =
        MotionBetween(before.rover.gauge_from_left, from * step.to_from_from.Inverse(),
                      SecondsFrom(StampOf(frame - 1), StampOf(frame)));
    carried.speed_mps = carried_.speed_mps;
    return carried;
  }

  CarriedMotion MotionBetween(const Rigid3& from, const Rigid3& to, double duration_s) const {
    const Eigen::Vector3d turn = LogRotation(from.rotation.conjugate() * to.rotation);
    return {(to.translation - from.translation).norm() / duration_s,
            model_.imu_from_left.rotation * turn / duration_s};
  }

  // Frames that something at `frame` or later is measured against.
  std::vector<int> ClonesFor(int frame) const {
    std::vector<int> kept;
    for (const auto& [from, last] : last_use_) {
      if (from < frame && last >= frame) kept.push_back(from);
    }
    return kept;
  }

  std::vector<VisualStep> StepsTo(int frame) const {
    const auto found = steps_.find(frame);
    return found == steps_.end() ? std::vector<VisualStep>() : found->second;
  }

  double InnovationOf(const Belief& belief, const VisualStep& step) const {
    return InnovationSigmas(belief, VisualMotionOf(belief, step, NoiseFactor(step)));
  }

  // Of some combinations of its coordinates, a row each.
  double InnovationOf(const Belief& belief, const VisualStep& step,
                      const Eigen::MatrixXd& combined) const {
    const Measurement all = VisualMotionOf(belief, step, NoiseFactor(step));
    return InnovationSigmas(belief, {combined * all.residual, combined * all.jacobian,
                                     combined * all.noise * combined.transpose()});
  }

  // Of the distance alone, in the direction in which the wheels drive: theirs to be wrong about.
  double InnovationAlong(const Belief& belief, const Eigen::Vector3d& way,
                         const VisualStep& step) const {
    if (!(way.norm() > 0.0)) return 0.0;
    return InnovationOf(belief, step, AxesOf(belief, way).topRows<1>());
  }

  // Of the current camera's motion: along the way, two aside, the turns.
  static Matrix6d AxesOf(const Belief& belief, const Eigen::Vector3d& way) {
    const Eigen::Vector3d along =
        belief.rover.gauge_from_left.rotation.conjugate() * way.normalized();
    const Eigen::Vector3d aside = along.unitOrthogonal();
    Matrix6d axes = Matrix6d::Zero();
    axes.topLeftCorner<3, 3>() << along.transpose(), aside.transpose(),
        along.cross(aside).transpose();
    axes.bottomRightCorner<3, 3>().setIdentity();
    return axes;
  }

  void NoteAgreement(const Belief& belief, const Eigen::Vector3d& way, const VisualStep& step) {
    if (!(way.norm() > 0.0)) return;
    const Matrix6d axes = AxesOf(belief, way);
    along_.Add(InnovationOf(belief, step, axes.topRows<1>()), 1);
    aside_.Add(InnovationOf(belief, step, axes.middleRows<2>(1)), 2);
    turn_.Add(InnovationOf(belief, step, axes.bottomRows<3>()), 3);
  }

  // Frames that are posed against the same keyframe share the noise of what is seen of it. The one
  // that carries on from it, to be a keyframe itself, is believed; all others together count once.
  double NoiseFactor(const VisualStep& step) const {
    if (uses_.contains(step.to)) return 1.0;
    return std::max(1, uses_.at(step.from) - 1);
  }

  Prediction WithSlip(Prediction prediction) const {
    constexpr double kAside = 0.1;  // of the slip along the way
    const Eigen::Vector3d way = model_.filter.burst_slip * prediction.way_in_gauge;
    prediction.noise.block<3, 3>(kPosition, kPosition) +=
        way * way.transpose() + kAside * kAside * way.squaredNorm() * Eigen::Matrix3d::Identity();
    return prediction;
  }

  // The wheels' metres follow the images', whose own scale nothing here measures: its error goes
  // with the distance from the first frame.
  void AddVisualScale(EstimatedPose& pose) const {
    const Eigen::Vector3d& way = pose.gauge_from_left.translation;
    const double sigma = model_.filter.vision_scale_sigma;
    pose.covariance.topLeftCorner<3, 3>() += sigma * sigma * way * way.transpose();
  }

  const Dataset& dataset_;
  const RoverModel& model_;
  std::span<const int> references_;
  WheelWay way_;
  std::span<const InertialSample> gyro_;
  std::map<int, std::vector<VisualStep>> steps_;  // by the frame they lead to
  std::map<int, int> last_use_, uses_;            // of a frame that steps begin at
  CarriedMotion carried_;
  std::vector<Belief> filtered_;
  std::vector<Advance> advances_;
  MeanSquare along_{1}, aside_{2}, turn_{3};
  EstimatedMotion motion_;
};

}  // namespace

EstimatedMotion EstimateMotion(const Dataset& dataset, std::span<const VisualStep> visual,
                               const DeadReckoningOptions& options, const FilterOptions& filter,
                               std::span<const int> references) {
  if (!dataset.rig.imu_from_left) {
    throw DataError(
        fmt::format("{}: expected imu_from_left, without which nothing that the rover's "
                    "sensors measure tells of its cameras, found none",
                    dataset.rig.source));
  }
  const bool is_blind = visual.empty() || !filter.use_vision;
  const auto without = [&](const char* option) {
    return is_blind ? std::string() : fmt::format("; --set filter.{}=false does without", option);
  };
  if (filter.use_wheels) RequireRecord(dataset.wheels, "wheels", without("use_wheels"));
  if (filter.use_gyro) RequireRecord(dataset.inertial, "inertial unit", without("use_gyro"));
  if (is_blind && filter.use_wheels) {
    RequireNoGap(dataset.wheels, "odometry.txt", dataset, options.max_gap_s);
  }
  if (is_blind && filter.use_gyro) {
    RequireNoGap(dataset.inertial, "imu.txt", dataset, options.max_gap_s);
  }
  const RoverModel model{*dataset.rig.imu_from_left, ContactInImu(dataset.rig, options), options,
                         filter};
  return Follower(dataset, visual, model, references).Follow();
}

}  // namespace rigmap
