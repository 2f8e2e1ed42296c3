#include "workflows/part_options.h"

#include <gmock/gmock.h>

#include <set>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/changed_option.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "workflows/print_options.h"

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

// To make them anew: rigmap options > config/default.yaml
//                    rigmap options --format markdown > docs/options.md
TEST(DefaultFile, IsTheGeneratedOne) {
  EXPECT_EQ(ReadTextFile(kDefaults), PrintOptions("yaml"));
  EXPECT_EQ(ReadTextFile(RIGMAP_DOCS "/options.md"), PrintOptions("markdown"));
}

TEST(DefaultFile, GivesExactlyTheDefaults) {
  EXPECT_EQ(WritePartOptions(LoadPartOptions(kDefaults, {})), WritePartOptions(PartOptions()));
}

TEST(PrintOptionsTest, RefusesAnUnknownFormat) {
  EXPECT_EQ(MessageOf<UsageError>([] { PrintOptions("html"); }),
            "--format: expected yaml or markdown, found 'html'");
}

TEST(PartOptionsDeclaration, GivesEachOptionAReasonAndAName) {
  PartOptions options;
  for (const OptionSection& section : options.Sections()) {
    EXPECT_FALSE(section.about.empty()) << section.name;
    std::set<std::string> names;
    for (const OptionField& field : section.fields) {
      EXPECT_THAT(field.reason, testing::EndsWith(".")) << section.name << "." << field.name;
      EXPECT_TRUE(names.insert(field.name).second) << section.name << "." << field.name;
    }
  }
}

TEST(PartOptionsDeclaration, HasDefaultsInRange) { EXPECT_NO_THROW(PartOptions().Validate()); }

TEST(PartOptionsDeclaration, LimitsEveryNumber) {
  PartOptions options;
  for (const OptionSection& section : options.Sections()) {
    for (const OptionField& field : section.fields) {
      if (std::holds_alternative<bool*>(field.value)) continue;
      EXPECT_THAT(UsageErrorOf(section.name + "." + field.name + "=-1"),
                  AllOf(HasSubstr("--set " + section.name + "." + field.name),
                        HasSubstr("expected " + AllowedText(field)), HasSubstr("-1")));
    }
  }
}

TEST(PartOptionsText, ReadsBackWithEveryOptionChanged) {
  PartOptions options;
  for (const OptionSection& section : options.Sections()) {
    for (const OptionField& field : section.fields) {
      const std::string before = OptionValueText(field);
      ChangeOption(field);
      EXPECT_NE(OptionValueText(field), before) << section.name << "." << field.name;
    }
  }
  // 0, or beyond the nearest depth.
  options.dense.max_range_m = options.clouds.max_depth_m = 7.25;
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
  EXPECT_EQ(options.dense.method, DenseMethod::kBm);
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

TEST_F(PartOptionsFile, NamesFileAndLineOfWhatIsNotAllowed) {
  EXPECT_EQ(MessageOf<UsageError>([&] { Load("dense:\n  method: magic\n"); }),
            (folder_.Path() / "my.yaml").string() +
                ":2: option method: expected sgm or bm, found 'magic'");
  EXPECT_THAT(MessageOf<UsageError>([&] { Load("fusion: {voxel_m: -1}\n"); }),
              HasSubstr("my.yaml:1: option voxel_m: expected 0 to 1000, found -1"));
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
  // One option limits another.
  EXPECT_THAT(UsageErrorOf("fusion.min_views=10"), HasSubstr("at most fusion.neighbours + 1"));
  EXPECT_THAT(UsageErrorOf("dense.large_step_cost=8"), HasSubstr("dense.small_step_cost"));
  EXPECT_THAT(UsageErrorOf("matching.sure_revisit_inliers=14"),
              HasSubstr("matching.min_revisit_inliers"));
}

TEST(Assignment, MayHoldPointsAndEqualSignsInItsValue) {
  EXPECT_THAT(UsageErrorOf("dense.method=a=b.c"), HasSubstr("a=b.c"));
}

}  // namespace
}  // namespace rigmap
