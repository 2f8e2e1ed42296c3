// The pool of a rig file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "dataset/rig_file.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RigPoolFileTest : public testing::Test {
 protected:
  StereoRig Read(const std::string& text) const {
    return ReadRigFile(folder_.Write("rig.yaml", text));
  }
  TemporaryFolder folder_;
};

TEST_F(RigPoolFileTest, KeepsWhatEachPartTold) {
  StereoRig start = Read(SampleRigText());
  RigWithoutPart first{{"0123456789ab", "00000000000f"}, CalibrationVector::Random(), {}};
  RigWithoutPart second{std::vector<std::string>(20, "123456789012"), CalibrationVector::Ones(),
                        CalibrationMatrix(2.0 * CalibrationMatrix::Identity())};
  PooledRig rig{start, RigPool{start, {first, second}}};
  rig.rig.calibration_covariance = CalibrationMatrix::Identity();
  const std::string text = WritePooledRigFile(rig);
  const PooledRig read = ReadPooledRigFile(folder_.Write("pooled.yaml", text));
  ASSERT_TRUE(read.pool);
  EXPECT_EQ(WritePooledRigFile(read), text);
  EXPECT_EQ(WriteRigFile(read.pool->start), WriteRigFile(start));
  ASSERT_EQ(read.pool->parts.size(), 2U);
  EXPECT_EQ(read.pool->parts[0].frames, first.frames);
  EXPECT_EQ(read.pool->parts[0].correction, first.correction);
  EXPECT_FALSE(read.pool->parts[0].covariance);
  EXPECT_EQ(read.pool->parts[1].frames, second.frames);
  EXPECT_EQ(read.pool->parts[1].covariance, second.covariance);
  EXPECT_EQ(WriteRigFile(ParseRigFile(text, "rig")), WriteRigFile(rig.rig));
  EXPECT_FALSE(ReadPooledRigFile(folder_.Write("rig.yaml", SampleRigText())).pool);
}

TEST_F(RigPoolFileTest, NamesTheLineOfWhatIsWrong) {
  const StereoRig start = Read(SampleRigText());
  const RigWithoutPart part{{"0123456789ab"}, CalibrationVector::Ones(), {}};
  const std::string text = WritePooledRigFile({start, RigPool{start, {part}}});
  const auto complaint = [&](const std::string& from, const std::string& to) {
    return MessageOf<DataError>([&] { Read(Replaced(text, from, to)); });
  };
  EXPECT_THAT(complaint("  parts:", "  partz:"), AllOf(HasSubstr("rig.yaml:"), HasSubstr("partz")));
  EXPECT_THAT(complaint("    - frames:", "    - colour: red\n      frames:"), HasSubstr("colour"));
  EXPECT_THAT(complaint("0123456789ab", "yesterday"), HasSubstr("hexadecimal, found 'yesterday'"));
  EXPECT_THAT(complaint("correction: [1,", "correction: ["), HasSubstr("19"));
  EXPECT_THAT(complaint("    left:", "    baseline_m: 0.12\n    left:"), HasSubstr("baseline_m"));
}

}  // namespace
}  // namespace rigmap
