#include "report/bundle.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::HasSubstr;

TEST(BundleTest, HasAStyle) { EXPECT_THAT(std::string(ReportStyle()), HasSubstr("@media print")); }

TEST(BundleTest, IsSmallAndNamesItsLicences) {
  if (ReportScripts().empty()) GTEST_SKIP() << "built without node: reports are plain";
  EXPECT_LT(ReportScripts().size() + ReportStyle().size(), 1'000'000U);
  const std::string scripts(ReportScripts());
  EXPECT_THAT(scripts, HasSubstr("three 0."));
  EXPECT_THAT(scripts, HasSubstr("uplot 1."));
  EXPECT_THAT(scripts, HasSubstr("Permission is hereby granted"));
  // Which would end the element that holds them.
  EXPECT_EQ(scripts.find("</script"), std::string::npos);
  EXPECT_EQ(scripts.find("<!--"), std::string::npos);
}

}  // namespace
}  // namespace rigmap
