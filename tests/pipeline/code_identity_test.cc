#include "pipeline/code_identity.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <stdexcept>

namespace rigmap {
namespace {

TEST(CodeIdentities, CoverEveryRoomOnceInOrder) {
  const auto identities = CodeIdentities();
  EXPECT_TRUE(std::ranges::is_sorted(identities, {}, &CodeIdentity::unit));
  std::set<std::string_view> units, hashes;
  for (const CodeIdentity& identity : identities) {
    units.insert(identity.unit);
    hashes.insert(identity.hash);
    EXPECT_EQ(identity.hash.size(), 32U) << identity.unit;
  }
  EXPECT_EQ(units.size(), identities.size());
  // No two are made of the same files.
  EXPECT_EQ(hashes.size(), identities.size());
  EXPECT_TRUE(units.contains("src/fusion"));
  EXPECT_TRUE(units.contains("workflows/stages/fusion"));
}

TEST(CodeHere, IsKnownForSourcesOfStagesOnly) { EXPECT_THROW(CodeHere(), std::logic_error); }

TEST(SourceVersion, IsSaid) { EXPECT_FALSE(SourceVersion().empty()); }

}  // namespace
}  // namespace rigmap
