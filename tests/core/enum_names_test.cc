#include "core/enum_names.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

enum class Season { kSpring, kSummer, kAutumn };
constexpr auto NamesOf(Season) { return std::array{"spring", "summer", "autumn"}; }

TEST(EnumNames, StandInTheOrderOfTheEnumeration) {
  EXPECT_STREQ(NameOf(Season::kSpring), "spring");
  EXPECT_STREQ(NameOf(Season::kAutumn), "autumn");
  static_assert(NamesOf(Season{}).size() == 3);
}

}  // namespace
}  // namespace rigmap
