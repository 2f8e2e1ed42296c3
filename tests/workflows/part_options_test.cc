#include "workflows/part_options.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kDefaults = RIGMAP_CONFIG "/default.yaml";

class PartOptionsFile : public testing::Test {
 protected:
  PartOptions Load(const std::string& text, const std::vector<std::string>& assignments = {}) {
    return LoadPartOptions(WriteTestFile(folder_.Path() / "my.yaml", text), assignments);
  }
  std::string DataErrorOf(const std::string& text) {
    return MessageOf<DataError>([&] { Load(text); });
  }
  TemporaryFolder folder_;
};

std::string UsageErrorOf(const std::string& assignment) {
  return MessageOf<UsageError>([&] { LoadPartOptions({}, {assignment}); });
}

TEST(DefaultFile, GivesExactlyTheDefaults) {
  EXPECT_EQ(WritePartOptions(LoadPartOptions(kDefaults, {})), WritePartOptions(PartOptions()));
}

TEST(DefaultFile, ListsAllOptionsInOrderAndNoOther) {
  const YamlNode file = ReadYaml(kDefaults);
  PartOptions options;
  const auto sections = options.Sections();
  ASSERT_EQ(file.entries.size(), sections.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const auto& [name, fields] = sections[i];
    EXPECT_EQ(file.entries[i].first, name);
    std::vector<std::string> listed, expected;
    for (const auto& entry : file.entries[i].second.entries) listed.push_back(entry.first);
    for (const OptionField& field : fields) expected.push_back(field.name);
    EXPECT_EQ(listed, expected) << name;
  }
}

TEST(DefaultFile, ExplainsEverySectionAndOption) {
  std::istringstream lines(ReadTextFile(kDefaults));
  bool explained = false;
  for (std::string line; std::getline(lines, line);) {
    const auto first = line.find_first_not_of(' ');
    if (first == std::string::npos) {
      explained = false;
    } else if (line[first] == '#') {
      explained = true;
    } else {
      // A comment may hold for several options that follow it.
      EXPECT_TRUE(explained) << line;
      if (first == 0) explained = false;
    }
  }
}

TEST(PartOptionsText, ReadsBackWithEveryOptionChanged) {
  PartOptions options;
  for (const auto& [name, fields] : options.Sections()) {
    for (const OptionField& field : fields) {
      std::visit(
          [](auto* value) {
            using Value = std::decay_t<decltype(*value)>;
            if constexpr (std::is_same_v<Value, bool>) *value = !*value;
            if constexpr (std::is_same_v<Value, int>) *value += 2;
            if constexpr (std::is_same_v<Value, double>) *value = 0.93 * *value + 1e-3 / 3.0;
          },
          field.value);
    }
  }
  options.dense.method = "bm";
  options.dense.max_range_m = 7.25;  // 0, or beyond the nearest depth
  options.mapping.method = "triangulate";
  options.adjustment.refine_rig = "rotation";
  const TemporaryFolder folder;
  const auto path = WriteTestFile(folder.Path() / "a.yaml", WritePartOptions(options));
  EXPECT_EQ(WritePartOptions(LoadPartOptions(path, {})), WritePartOptions(options));
  EXPECT_NE(WritePartOptions(options), WritePartOptions(PartOptions()));
}

TEST_F(PartOptionsFile, ChangesOnlyWhatItNames) {
  PartOptions expected;
  expected.voxel.voxel_m = 0.025;
  expected.masks.sky = false;
  EXPECT_EQ(WritePartOptions(Load("fusion: {voxel_m: 0.025}\nmasks:\n  sky: false\n")),
            WritePartOptions(expected));
}

TEST_F(PartOptionsFile, MayBeEmptyOrHaveEmptySections) {
  EXPECT_EQ(WritePartOptions(Load("")), WritePartOptions(PartOptions()));
  EXPECT_EQ(WritePartOptions(Load("fusion:\n# nothing yet\n")), WritePartOptions(PartOptions()));
}

TEST_F(PartOptionsFile, YieldsToAssignments) {
  const auto options =
      Load("fusion: {voxel_m: 0.025, neighbours: 6}\n", {"fusion.voxel_m=0.05", "dense.method=bm"});
  EXPECT_EQ(options.voxel.voxel_m, 0.05);
  EXPECT_EQ(options.fusion.neighbours, 6);
  EXPECT_EQ(options.dense.method, "bm");
}

TEST_F(PartOptionsFile, NamesFileAndLineOfWhatItCannotUse) {
  EXPECT_THAT(DataErrorOf("masks: {sky: true}\nfusoin:\n  voxel_m: 0.02\n"),
              AllOf(HasSubstr("my.yaml:2"), HasSubstr("'fusoin'"), HasSubstr("fusion")));
  EXPECT_THAT(DataErrorOf("fusion:\n  neighbours: 4\n  voxel: 0.02\n"),
              AllOf(HasSubstr("my.yaml:3"), HasSubstr("'voxel'"), HasSubstr("voxel_m")));
  EXPECT_THAT(DataErrorOf("fusion:\n  voxel_m: fine\n"),
              AllOf(HasSubstr("my.yaml:2"), HasSubstr("number"), HasSubstr("'fine'")));
  EXPECT_THAT(DataErrorOf("fusion:\n  neighbours: 4.5\n"), HasSubstr("my.yaml:2"));
  EXPECT_THAT(DataErrorOf("fusion: 3\n"), HasSubstr("my.yaml:1"));
  EXPECT_THAT(DataErrorOf("- fusion\n- dense\n"), HasSubstr("my.yaml"));
}

TEST(PartOptionsFileThatIsMissing, IsADataError) {
  EXPECT_THAT(MessageOf<DataError>([] { LoadPartOptions("/nowhere/my.yaml", {}); }),
              HasSubstr("/nowhere/my.yaml"));
}

TEST(Assignment, ThatCannotBeUsedSaysWhatIsThere) {
  EXPECT_THAT(UsageErrorOf("fusion.voxel_m"), HasSubstr("stage.option=value"));
  EXPECT_THAT(UsageErrorOf("voxel_m=0.02"), HasSubstr("stage.option=value"));
  EXPECT_THAT(UsageErrorOf("fusoin.voxel_m=0.02"),
              AllOf(HasSubstr("'fusoin'"), HasSubstr("dense")));
  EXPECT_THAT(UsageErrorOf("fusion.voxel=0.02"), AllOf(HasSubstr("voxel"), HasSubstr("voxel_m")));
  EXPECT_THAT(UsageErrorOf("fusion.voxel_m=fine"), HasSubstr("'fine'"));
  EXPECT_THAT(UsageErrorOf("fusion.voxel_m="), HasSubstr("fusion.voxel_m"));
  EXPECT_THAT(UsageErrorOf("masks.sky=maybe"), HasSubstr("true or false"));
}

TEST(Assignment, OutOfRangeNamesTheOption) {
  EXPECT_THAT(UsageErrorOf("fusion.voxel_m=-1"),
              AllOf(HasSubstr("fusion.voxel_m"), HasSubstr("-1")));
  EXPECT_THAT(UsageErrorOf("dense.method=magic"),
              AllOf(HasSubstr("dense.method"), HasSubstr("sgm")));
  EXPECT_THAT(UsageErrorOf("mapping.method=magic"), HasSubstr("mapping.method"));
  EXPECT_THAT(UsageErrorOf("gates.registered=0"), HasSubstr("gates.registered"));
}

TEST(Assignment, MayHoldPointsAndEqualSignsInItsValue) {
  EXPECT_THAT(UsageErrorOf("dense.method=a=b.c"), HasSubstr("a=b.c"));
}

}  // namespace
}  // namespace rigmap
