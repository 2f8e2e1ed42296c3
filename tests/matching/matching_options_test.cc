#include "matching/matching_options.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(MatchingOptions, DefaultsAreValidAndReadBack) {
  MatchingOptions options;
  EXPECT_NO_THROW(RequireValid(options));
  SetOption("matching", "neighbours", "7", options.Fields());
  SetOption("matching", "min_overlap", "0.5", options.Fields());
  EXPECT_EQ(options.neighbours, 7);
  EXPECT_EQ(options.min_overlap, 0.5);
}

TEST(MatchingOptions, EveryFieldIsChecked) {
  MatchingOptions defaults;
  for (const OptionField& field : defaults.Fields()) {
    MatchingOptions options;
    EXPECT_THROW(SetOption("matching", field.name, "-1", options.Fields()), UsageError)
        << field.name;
  }
}

TEST(MatchingOptions, ALoopClosureAloneNeedsNoFewerInliersThanOneAmongOthers) {
  EXPECT_NO_THROW(
      RequireValid(MatchingOptions{.min_revisit_inliers = 20, .sure_revisit_inliers = 20}));
  EXPECT_THROW(RequireValid(MatchingOptions{.min_revisit_inliers = 20, .sure_revisit_inliers = 19}),
               UsageError);
}

}  // namespace
}  // namespace rigmap
