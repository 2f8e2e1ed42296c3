#include "core/artefact.h"

#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

struct Sample {
  std::vector<double> numbers;
  std::optional<int> count;
  std::string name;

  bool operator==(const Sample&) const = default;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(numbers, count, name);
  }
};

const Sample kSample{{1.5, -0.0, 1e300}, std::nullopt, std::string("line\nend\0more", 13)};

class ArtefactTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "stage" / "sample.bin";
  std::string key_ = HashText("inputs");
};

TEST_F(ArtefactTest, ReadsBackWhatWasWritten) {
  WriteArtefact(path_, key_, kSample);
  EXPECT_TRUE(HasArtefact(path_, key_));
  EXPECT_EQ(ReadArtefact<Sample>(path_, key_), kSample);
}

TEST_F(ArtefactTest, WritingTwiceGivesEqualBytes) {
  WriteArtefact(path_, key_, kSample);
  const std::string first = ReadTextFile(path_);
  WriteArtefact(path_, key_, kSample);
  EXPECT_EQ(ReadTextFile(path_), first);
}

TEST_F(ArtefactTest, AnotherKeyIsNotThere) {
  WriteArtefact(path_, key_, kSample);
  EXPECT_FALSE(HasArtefact(path_, HashText("other inputs")));
  EXPECT_FALSE(ReadArtefact<Sample>(path_, HashText("other inputs")).has_value());
}

TEST_F(ArtefactTest, MissingFileIsNotThere) {
  EXPECT_FALSE(HasArtefact(path_, key_));
  EXPECT_FALSE(ReadArtefact<Sample>(path_, key_).has_value());
}

TEST_F(ArtefactTest, TruncatedAnywhereIsNotRead) {
  WriteArtefact(path_, key_, kSample);
  const std::string whole = ReadTextFile(path_);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    folder_.Write("cut.bin", whole.substr(0, size));
    EXPECT_FALSE(ReadArtefact<Sample>(folder_.Path() / "cut.bin", key_).has_value()) << size;
  }
}

TEST_F(ArtefactTest, ChangedAnywhereIsNotRead) {
  WriteArtefact(path_, key_, kSample);
  const std::string whole = ReadTextFile(path_);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    folder_.Write("changed.bin", changed);
    EXPECT_FALSE(ReadArtefact<Sample>(folder_.Path() / "changed.bin", key_).has_value()) << i;
  }
}

TEST_F(ArtefactTest, LongOnesAreReadBack) {
  Sample sample = kSample;
  for (int i = 0; i < 100'000; ++i) sample.numbers.push_back(0.1 * i);
  WriteArtefact(path_, key_, sample);
  EXPECT_EQ(ReadArtefact<Sample>(path_, key_), sample);
  std::string changed = ReadTextFile(path_);
  changed[changed.size() / 2] ^= 1;
  folder_.Write("stage/sample.bin", changed);
  EXPECT_TRUE(HasArtefact(path_, key_)) << "its ends alone are looked at";
  EXPECT_FALSE(ReadArtefact<Sample>(path_, key_).has_value());
}

TEST(HashTextTest, TellsTextsApart) {
  EXPECT_EQ(HashText("abc"), HashText("abc"));
  EXPECT_NE(HashText("abc"), HashText("abd"));
  EXPECT_NE(HashText(""), HashText(std::string(1, '\0')));
  EXPECT_EQ(HashText("abc").size(), 32U);
  EXPECT_EQ(HashText("abc").find_first_not_of("0123456789abcdef"), std::string::npos);
}

}  // namespace
}  // namespace rigmap
