#include "registration/registration_options.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TEST(Resolved, PlainIsWhatItSaysWhateverElseIsAsked) {
  RegistrationOptions asked;
  asked.method = RegistrationMethod::kGeneralized;
  asked.map_keyframes = 7;
  const RegistrationOptions plain = Resolved(asked);
  EXPECT_EQ(plain.method, RegistrationMethod::kPointToPoint);
  EXPECT_EQ(plain.first_guess, FirstGuess::kPreviousMotion);
  EXPECT_EQ(plain.map_keyframes, 1);
  EXPECT_EQ(plain.keyframe_overlap, 1.0);
  EXPECT_EQ(plain.kept_share, 1.0);
  asked.way = RegistrationWay::kImproved;
  EXPECT_EQ(OptionsText(Resolved(asked)), OptionsText(asked));
}

}  // namespace
}  // namespace rigmap
