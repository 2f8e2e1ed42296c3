#include "adjustment/pool_calibrations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "adjustment/calibration_prior.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

class PoolCalibrationsTest : public testing::Test {
 protected:
  // What a part says of a rig that is off by `truth`, each parameter to a twentieth of its prior in
  // each of eight stretches; it has been corrected to `at`.
  CalibrationWitness Witness(const CalibrationVector& truth, const CalibrationVector& at) {
    CalibrationWitness part{at, {}};
    for (int stretch = 0; stretch < 8; ++stretch) {
      CalibrationBlock block;
      block.information.diagonal() = 400.0 * prior_.sigmas.cwiseAbs2().cwiseInverse();
      CalibrationVector told = truth;
      for (int i = 0; i < kCalibrationSize; ++i) {
        told(i) += random_.Normal(prior_.sigmas(i) / 20.0);
      }
      block.score = block.information * (told - at);
      part.equations.stretches.push_back(block);
      part.equations.score += block.score;
      part.equations.information += block.information;
    }
    part.equations.regions = part.equations.stretches;
    part.equations.score_covariance = part.equations.information;
    return part;
  }
  CalibrationVector Off(double of_rotation, double of_focal) const {
    CalibrationVector off = CalibrationVector::Zero();
    off(kRotationY) = of_rotation * prior_.sigmas(kRotationY);
    off(kLogFocal) = of_focal * prior_.sigmas(kLogFocal);
    return off;
  }
  PooledCalibration Pool(const std::vector<CalibrationWitness>& parts) const {
    return PoolCalibrations(parts, prior_, options_).value();
  }

  AdjustmentOptions options_;
  CalibrationPrior prior_ = PriorOf(LocCamRig(), options_);
  SeededRandom random_;
};

TEST_F(PoolCalibrationsTest, FindsWhatTheyHaveInCommonWhereverEachWasCorrectedTo) {
  const CalibrationVector truth = Off(2.0, -1.5);
  const PooledCalibration pooled = Pool({Witness(truth, CalibrationVector::Zero()),
                                         Witness(truth, truth), Witness(truth, Off(1.0, 1.0))});
  EXPECT_EQ(pooled.refined, RigRefinement::kAll);
  const CalibrationVector off =
      (pooled.pooled.correction - truth).cwiseQuotient(prior_.sigmas).cwiseAbs();
  EXPECT_LT(off.maxCoeff(), 0.05);
  for (const WitnessComparison& part : pooled.parts) {
    EXPECT_LT(part.square_per_parameter, 1.6);
    EXPECT_GT(part.largest_sigmas, 0.0);
    EXPECT_LT(part.largest_sigmas, 3.0);
  }
  // Three know it better than one.
  const PooledCalibration single = Pool({Witness(truth, truth)});
  EXPECT_LT(pooled.pooled.covariance(kRotationY, kRotationY),
            0.5 * single.pooled.covariance(kRotationY, kRotationY));
}

TEST_F(PoolCalibrationsTest, HoldsTheFocalLengthThatAPartHoldsBesideAField) {
  const CalibrationVector truth = Off(2.0, -1.5), held = Off(2.0, 0.0);
  std::vector<CalibrationWitness> parts{Witness(truth, held), Witness(truth, held)};
  EXPECT_EQ(Pool(parts).refined, RigRefinement::kAll);
  for (CalibrationWitness& part : parts) {
    part.equations.of_field.information.diagonal() =
        1e-6 * prior_.sigmas.cwiseAbs2().cwiseInverse();
  }
  const PooledCalibration pooled = Pool(parts);
  EXPECT_EQ(pooled.refined, RigRefinement::kAllButFocal);
  EXPECT_EQ(pooled.pooled.correction(kLogFocal), 0.0);
  EXPECT_GT(std::sqrt(pooled.pooled.covariance(kLogFocal, kLogFocal)),
            0.5 * std::abs(truth(kLogFocal)));
  // Parts that freed it themselves follow it together as well.
  for (CalibrationWitness& part : parts) {
    part = Witness(truth, truth);
    part.equations.of_field.information.diagonal() =
        1e-6 * prior_.sigmas.cwiseAbs2().cwiseInverse();
  }
  EXPECT_EQ(Pool(parts).refined, RigRefinement::kAll);
}

TEST_F(PoolCalibrationsTest, NamesAPartOfAnotherRig) {
  const CalibrationVector truth = Off(1.0, 0.0), other = Off(-1.0, 0.0);
  const PooledCalibration pooled =
      Pool({Witness(truth, truth), Witness(truth, truth), Witness(other, other)});
  EXPECT_GT(pooled.parts[2].square_per_parameter, 10.0);
  EXPECT_GT(pooled.parts[2].largest_sigmas, 3.0);
  EXPECT_GT(pooled.parts[2].square_per_parameter, 2.0 * pooled.parts[0].square_per_parameter);
}

// Rigs of twelve parts differ by a fifth of what rig files are usually off by, which each part
// knows to a fiftieth. The rig of a thirteenth is so much off the pool, and its prior says so.
TEST_F(PoolCalibrationsTest, WhatRigsGiveFromPartToPartIsUnknownOfTheNext) {
  constexpr double kGives = 0.2;
  std::vector<CalibrationWitness> parts;
  for (int i = 0; i < 12; ++i) {
    CalibrationVector rig = CalibrationVector::Zero();
    for (int k = 0; k < kCalibrationSize; ++k) rig(k) = random_.Normal(kGives * prior_.sigmas(k));
    parts.push_back(Witness(rig, CalibrationVector::Zero()));
  }
  const PooledCalibration pooled = Pool(parts);
  const auto sigmas = [&](const CalibrationMatrix& covariance) {
    return covariance.diagonal().cwiseSqrt().cwiseQuotient(prior_.sigmas).eval();
  };
  for (const double sigma : sigmas(pooled.between)) EXPECT_NEAR(sigma, kGives, 0.05);
  for (const double sigma : sigmas(pooled.pooled.covariance)) EXPECT_GT(sigma, 0.16);
  for (const double sigma : sigmas(pooled.parts[3].without.covariance)) EXPECT_GT(sigma, 0.16);
  // Of parts of one rig the pool is as sure as their noise leaves it.
  const CalibrationVector zero = CalibrationVector::Zero();
  const PooledCalibration same =
      Pool({Witness(zero, zero), Witness(zero, zero), Witness(zero, zero), Witness(zero, zero)});
  for (const double sigma : sigmas(same.between)) EXPECT_LT(sigma, 0.03);
}

TEST_F(PoolCalibrationsTest, CorrectsNothingWhereNothingIsWrong) {
  const CalibrationVector zero = CalibrationVector::Zero();
  const PooledCalibration pooled = Pool({Witness(zero, zero), Witness(zero, zero)});
  EXPECT_EQ(pooled.refined, RigRefinement::kNone);
  EXPECT_TRUE(pooled.pooled.correction.isZero());
  // What is not corrected is still not known exactly.
  EXPECT_GT(pooled.pooled.covariance(kLogFocal, kLogFocal), 0.0);
}

// The images ask for a focal length, their stretches do not confirm it: k1 has made up for it as
// these paths wanted. Of that other parts know nothing.
TEST_F(PoolCalibrationsTest, WhatMakesUpForAHeldFocalLengthIsUnknown) {
  constexpr double kCoupled = 0.9, kAsked = 3.0;
  CalibrationWitness part = Witness(Off(4.0, 0.0), Off(4.0, 0.0));
  part.equations.score.setZero();
  part.equations.information.setZero();
  for (std::size_t i = 0; i < part.equations.stretches.size(); ++i) {
    CalibrationBlock& block = part.equations.stretches[i];
    CalibrationMatrix& information = block.information;
    information(kLogFocal, kLeftK1) = information(kLeftK1, kLogFocal) =
        kCoupled * std::sqrt(information(kLogFocal, kLogFocal) * information(kLeftK1, kLeftK1));
    const double of_focal = i % 4 == 3 ? -kAsked : kAsked;  // a quarter dissents
    block.score = information.col(kLogFocal) * of_focal * prior_.sigmas(kLogFocal);
    part.equations.score += block.score;
    part.equations.information += information;
  }
  part.equations.regions = part.equations.stretches;
  part.equations.score_covariance = part.equations.information;
  const PooledCalibration pooled = Pool({part});
  ASSERT_EQ(pooled.refined, RigRefinement::kAllButFocal);
  const double followed = kCoupled * 0.5 * kAsked * prior_.sigmas(kLeftK1);
  EXPECT_GT(pooled.pooled.covariance(kLeftK1, kLeftK1), followed * followed);
  // The focal length is known as well as before, of a file that has turned out this bad.
  const double known = std::sqrt(pooled.pooled.covariance(kLogFocal, kLogFocal));
  EXPECT_GE(known, prior_.sigmas(kLogFocal));
  EXPECT_LT(known, 1.2 * prior_.sigmas(kLogFocal));
}

TEST_F(PoolCalibrationsTest, KnowsTheRigWithoutEachPart) {
  const CalibrationVector truth = Off(2.0, -1.5);
  const CalibrationWitness a = Witness(truth, truth), b = Witness(truth, Off(1.0, 0.0)),
                           c = Witness(truth, truth);
  const PooledCalibration pooled = Pool({a, b, c});
  const PooledCalibration others = Pool({a, c});
  EXPECT_EQ(pooled.parts[1].without.correction, others.pooled.correction);
  // Beside what each pool says of how rigs give, which the third part has a say in.
  const CalibrationMatrix known = pooled.parts[1].without.covariance - 1.5 * pooled.between;
  EXPECT_TRUE(known.isApprox(others.pooled.covariance - 1.5 * others.between, 1e-9));
  // Without the only one the prior is left.
  const PooledCalibration single = Pool({a});
  EXPECT_TRUE(single.parts[0].without.correction.isZero());
  EXPECT_TRUE((prior_.information * single.parts[0].without.covariance).eval().isIdentity(1e-9));
}

TEST(CorrectionBetween, IsTheInverseOfCorrected) {
  const StereoRig rig = LocCamRig();
  const CalibrationVector by = 0.01 * CalibrationVector::Random();
  const StereoRig corrected = Corrected(rig, by);
  EXPECT_TRUE(CorrectionBetween(rig, corrected).isApprox(by, 1e-9));
  EXPECT_LT(CorrectionBetween(corrected, Corrected(rig, by)).norm(), 1e-12);
}

}  // namespace
}  // namespace rigmap
