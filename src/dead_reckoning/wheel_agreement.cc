#include "dead_reckoning/internal/wheel_agreement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "dead_reckoning/internal/wheel_rolls.h"

namespace rigmap {
namespace {

// WheelVector by the kinematics of each wheel: least squares drawn to six like wheels on the frame
// of a rover, with the scatter that the rolls have about it.
class Model {
 public:
  explicit Model(const std::vector<WheelRoll>& rolls) {
    const Prior prior;
    const Information prior_information = prior.covariance.inverse();
    for (int round = 0; round < 2; ++round) {
      Information information = prior_information;
      Factors score = prior_information * prior.mean;
      for (const WheelRoll& roll : rolls) {
        const Rows rows = RowsOf(roll);
        information += rows.transpose() * rows / variance_;
        score += rows.transpose() * roll.shares / variance_;
      }
      covariance_ = information.inverse();
      factors_ = covariance_ * score;
      double squares = kAsExpected * kWheels * kExpected * kExpected;
      for (const WheelRoll& roll : rolls) squares += Off(roll).squaredNorm();
      variance_ = squares / (kWheels * (kAsExpected + static_cast<double>(rolls.size())));
    }
  }

  // Whether shares are known as well as wheels scatter.
  bool Knows(const WheelRoll& roll) const {
    return CovarianceOf(roll).trace() < kWheels * kExpected * kExpected;
  }

  // Root mean square over the wheels, in sigmas.
  double OffSigmas(const WheelRoll& roll) const {
    const WheelVector off = Off(roll);
    const SharesCovariance covariance =
        CovarianceOf(roll) + variance_ * SharesCovariance::Identity();
    return std::sqrt(off.dot(covariance.llt().solve(off)) / kWheels);
  }

 private:
  static constexpr int kFactors = 3 * static_cast<int>(kWheels);  // of one wheel after the other
  using Factors = Eigen::Matrix<double, kFactors, 1>;
  using Information = Eigen::Matrix<double, kFactors, kFactors>;
  using Rows = Eigen::Matrix<double, kWheels, kFactors>;
  using SharesCovariance = Eigen::Matrix<double, kWheels, kWheels>;

  static constexpr double kExpected = 0.01, kAsExpected = 2.0;  // scatter; rolls that have it

  // Wheels differ by a tenth and stand somewhere on a rover: three axles as far apart as it is
  // wide, give or take.
  struct Prior {
    Prior() {
      constexpr double kShare = 0.1, kHalf_m = 0.4, kHalfSigma_m = 0.3, kPosition_m = 0.05;
      constexpr std::array<double, kWheels> kLeft{1, -1, 1, -1, 1, -1}, kAhead{1, 1, 0, 0, -1, -1};
      Factors width = Factors::Zero(), length = Factors::Zero();
      for (std::size_t k = 0; k < kWheels; ++k) {
        const auto first = static_cast<Eigen::Index>(3 * k);
        mean.segment<3>(first) << 1.0, -kHalf_m * kLeft[k], kHalf_m * kAhead[k];
        width(first + 1) = kLeft[k];
        length(first + 2) = kAhead[k];
        covariance.diagonal().segment<3>(first) << kShare * kShare, kPosition_m * kPosition_m,
            kPosition_m * kPosition_m;
      }
      for (const Factors& size : {width, length}) {
        covariance += kHalfSigma_m * kHalfSigma_m * size * size.transpose();
      }
    }

    Factors mean = Factors::Zero();
    Information covariance = Information::Zero();
  };

  static Rows RowsOf(const WheelRoll& roll) {
    Rows rows = Rows::Zero();
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(kWheels); ++k) {
      rows.block<1, 3>(k, 3 * k) = roll.kinematics.col(k).transpose();
    }
    return rows;
  }

  WheelVector Off(const WheelRoll& roll) const { return roll.shares - RowsOf(roll) * factors_; }

  SharesCovariance CovarianceOf(const WheelRoll& roll) const {
    const Rows rows = RowsOf(roll);
    return rows * covariance_ * rows.transpose();
  }

  double variance_ = kExpected * kExpected;
  Factors factors_ = Factors::Zero();
  Information covariance_ = Information::Zero();
};

}  // namespace

WheelAgreement AgreementOfWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                 const std::vector<bool>& checked, const std::vector<bool>& asked,
                                 double wheel_radius_m) {
  constexpr double kMostSigmas = 2.0;  // of six wheels at once: one roll in 2000
  const WheelRolls all(dataset, motion, wheel_radius_m);
  std::vector<WheelRoll> rolls;
  for (std::size_t i = 1; i < checked.size(); ++i) {
    if (!checked[i]) continue;
    if (const auto roll = all.To(i)) rolls.push_back(*roll);
  }
  const Model model(rolls);
  WheelAgreement found;
  for (std::size_t i = 1; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    const auto roll = all.To(i);
    if (!roll) continue;
    if (model.OffSigmas(*roll) > kMostSigmas) {
      found.unlike.push_back(static_cast<int>(i));
    } else if (model.Knows(*roll)) {
      found.alike.push_back(static_cast<int>(i));
    }
  }
  return found;
}

}  // namespace rigmap
