// What the parts of a drive are called, and which rig their whole begins with.
#include "workflows/union_of_parts.h"

#include <gmock/gmock.h>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"
#include "core/error.h"
#include "core/file.h"
#include "dataset/rig_file.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> NamesOf(const std::vector<fs::path>& outs) {
  std::vector<std::string> names;
  for (const PartFolder& folder : NameParts(outs)) names.push_back(folder.name);
  return names;
}

TEST(NamePartsTest, TakesTheLastNameWhereThatTellsThemApart) {
  EXPECT_THAT(NamesOf({"/x/a/1", "/x/a/2/"}), ElementsAre("1", "2"));
}

TEST(NamePartsTest, TakesAsMuchOfThePathAsTellsThemApart) {
  EXPECT_THAT(NamesOf({"/x/a/1", "/x/b/1", "/x/b/2"}), ElementsAre("a-1", "b-1", "b-2"));
  EXPECT_THAT(NamesOf({"/x/a/parts/1", "/x/b/parts/1"}), ElementsAre("a-parts-1", "b-parts-1"));
}

TEST(NamePartsTest, CountsWherePathsReadAlike) {
  EXPECT_THAT(NamesOf({"/a-b/1", "/a/b-1", "/c/1"}), ElementsAre("a-b-1-1", "a-b-1-2", "c-1-3"));
}

TEST(NamePartsTest, RefusesAFolderThatIsGivenTwice) {
  EXPECT_THAT(MessageOf<UsageError>([] {
                NameParts({"/x/a/1", "/x/b/../a/1/"});
              }),
              HasSubstr("found /x/b/../a/1/ twice"));
  EXPECT_THAT(MessageOf<UsageError>([] { NameParts({}); }), HasSubstr("found none"));
}

// Each folder of data has remarks of its own: which one is meant must be told.
TEST(RemarksOfPartsTest, NameTheirPartUnlessAllMakeThem) {
  EXPECT_THAT(RemarksOfParts({{"1", {"no antenna", "gap"}}, {"2", {"gap", "no antenna", "gap"}}}),
              ElementsAre("no antenna", "gap"));
  EXPECT_THAT(
      RemarksOfParts({{"1", {"no antenna", "gap"}}, {"2", {"no antenna"}}, {"3", {"gap"}}}),
      ElementsAre("part 1: no antenna", "part 1: gap", "part 2: no antenna", "part 3: gap"));
}

TEST(AppendRecordTest, ARecordThatCannotBeUsedIsAGapOfTheOthers) {
  const WheelRecord good{{WheelSample{.stamp_ns = 1}}, ""}, bad{{}, "wheels: not there"};
  for (const auto& parts : {std::vector{good, bad}, std::vector{bad, good}}) {
    WheelRecord whole;
    for (const WheelRecord& part : parts) AppendRecord(part, whole);
    EXPECT_EQ(whole.samples.size(), 1U);
    EXPECT_EQ(whole.problem, "");
  }
  WheelRecord none;
  for (int i = 0; i < 2; ++i) AppendRecord(bad, none);
  EXPECT_EQ(none.problem, "wheels: not there");
}

class RigOfTheWhole : public testing::Test {
 protected:
  RigOfTheWhole() : start_(ReadRigFile(SimulatedPartFolder() / "calib.yaml")) {}

  // A file pooled from another drive, which knows more than the one that this began with.
  fs::path Pooled(const std::string& name, const std::string& frame) const {
    CalibrationVector correction = CalibrationVector::Zero();
    correction(kRotationY) = 1e-4;
    PooledRig file{Corrected(start_, correction), RigPool{start_, {}}};
    file.rig.calibration_covariance = PriorOf(start_, {}).sigmas.cwiseAbs2().asDiagonal();
    *file.rig.calibration_covariance *= 0.01;
    file.rig.antenna_in_left = Eigen::Vector3d(0.1, -0.5, 0.0);
    file.pool->parts.push_back({.frames = {frame}});
    return folder_.Write(name, WritePooledRigFile(file));
  }
  fs::path Part(const std::string& frames, const fs::path& rig) const {
    const fs::path out = folder_.Path() / (rig.stem().string() + "-" + frames.substr(0, 1));
    const ProgramEnd end =
        RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--frames", frames, "--rig", rig,
                   "--out", out, "--until", "odometry", "--quiet"});
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return out;
  }
  Dataset Unite(const std::vector<fs::path>& outs) const {
    return UniteParts(NameParts(outs), folder_.Path() / "whole").dataset;
  }

  TemporaryFolder folder_;
  StereoRig start_;
};

TEST_F(RigOfTheWhole, IsThatOfThePoolWhereOtherDrivesMadeIt) {
  const fs::path rig = Pooled("pooled.yaml", "0123456789ab");
  const Dataset whole = Unite({Part("0:5", rig), Part("4:8", rig)});
  const PooledRig file = ReadPooledRigFile(rig);
  EXPECT_EQ(DescribeRig(whole.rig), DescribeRig(file.rig));
  ASSERT_TRUE(whole.rig_pool);
  EXPECT_EQ(whole.rig_pool->parts.front().frames, file.pool->parts.front().frames);
  EXPECT_EQ(whole.rig_pool->parts.front().correction, file.pool->parts.front().correction);
}

// Calibrated as before any pool, but masks, antenna and the like are the file's.
TEST_F(RigOfTheWhole, IsTheOneBeforeAnyPoolWherePartsWereGivenDifferentOnes) {
  const Dataset whole = Unite({Part("0:5", Pooled("one.yaml", "0123456789ab")),
                               Part("4:8", Pooled("other.yaml", "ba9876543210"))});
  EXPECT_FALSE(whole.rig_pool);
  StereoRig expected = start_;
  expected.antenna_in_left = Eigen::Vector3d(0.1, -0.5, 0.0);
  EXPECT_LT(CorrectionBetween(expected, whole.rig).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_FALSE(whole.rig.calibration_covariance);
  EXPECT_EQ(whole.rig.antenna_in_left, expected.antenna_in_left);
}

// Where nothing of a part need be made anew, since the images are the same.
TEST_F(RigOfTheWhole, DataThatMovedAreTakenFromWhereTheyAreNow) {
  const fs::path data = CopyOfSimulatedPart(folder_.Path()), moved = folder_.Path() / "moved";
  const auto part = [&](const fs::path& from, const std::string& frames) {
    const fs::path out = folder_.Path() / ("of-" + frames.substr(0, 1));
    const ProgramEnd end = RunRigmap({"part", "--dataset", from, "--frames", frames, "--out", out,
                                      "--until", "odometry", "--quiet"});
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return out;
  };
  part(data, "0:5");
  part(data, "4:8");
  fs::rename(data, moved);
  const Dataset whole = Unite({part(moved, "0:5"), part(moved, "4:8")});
  ASSERT_EQ(whole.frames.size(), 8U);
  for (const StereoFrame& frame : whole.frames) EXPECT_TRUE(fs::exists(frame.left_path));
}

}  // namespace
}  // namespace rigmap
