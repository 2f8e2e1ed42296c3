#include "report/base64.h"

#include <gmock/gmock.h>

#include <vector>

namespace rigmap {
namespace {

std::string Of(const std::string& text) {
  return Base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// RFC 4648, section 10.
TEST(Base64Test, IsAsTheStandardHasIt) {
  EXPECT_EQ(Of(""), "");
  EXPECT_EQ(Of("f"), "Zg==");
  EXPECT_EQ(Of("fo"), "Zm8=");
  EXPECT_EQ(Of("foo"), "Zm9v");
  EXPECT_EQ(Of("foob"), "Zm9vYg==");
  EXPECT_EQ(Of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(Of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Of("\xff\xfe"), "//4=");
}

}  // namespace
}  // namespace rigmap
