#include "georeference/geodetic.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(Geodetic, RefusesWhatLiesNowhereOnEarth) {
  EXPECT_NO_THROW(RequireValid({52.2, 4.4, 3.0}));
  EXPECT_NO_THROW(RequireValid({-90.0, 359.0, -400.0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(RequireValid({90.1, 4.4, 3.0}), DataError);
  EXPECT_THROW(RequireValid({nan, 4.4, 3.0}), DataError);
  EXPECT_THROW(RequireValid({52.2, infinity, 3.0}), DataError);
  EXPECT_THROW(RequireValid({52.2, 4.4, nan}), DataError);
}

}  // namespace
}  // namespace rigmap
