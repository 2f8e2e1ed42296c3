#include "geometry/serialize.h"

#include <gtest/gtest.h>

#include <cereal/archives/binary.hpp>
#include <sstream>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

template <class Value>
Value RoundTrip(const Value& value) {
  std::stringstream stream;
  cereal::BinaryOutputArchive writer(stream);
  writer(value);
  cereal::BinaryInputArchive reader(stream);
  Value read;
  reader(read);
  return read;
}

TEST(Serialize, KeepsMotionsAndSimilaritiesToTheBit) {
  SeededRandom random;
  const Rigid3 motion = random.Motion(20.0);
  EXPECT_EQ(RoundTrip(motion).rotation.coeffs(), motion.rotation.coeffs());
  EXPECT_EQ(RoundTrip(motion).translation, motion.translation);
  const Sim3 similarity = random.Similarity(20.0);
  EXPECT_EQ(RoundTrip(similarity).scale, similarity.scale);
  EXPECT_EQ(RoundTrip(similarity).rotation.coeffs(), similarity.rotation.coeffs());
  EXPECT_EQ(RoundTrip(similarity).translation, similarity.translation);
}

TEST(Serialize, KeepsEveryFieldOfACamera) {
  const Camera camera{1, 2, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0};
  const Camera read = RoundTrip(camera);
  EXPECT_EQ(read.width, 1);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ((Eigen::Vector4d(read.fx, read.fy, read.cx, read.cy)),
            Eigen::Vector4d(3.0, 4.0, 5.0, 6.0));
  EXPECT_EQ((Eigen::Vector4d(read.k1, read.k2, read.p1, read.p2)),
            Eigen::Vector4d(7.0, 8.0, 9.0, 10.0));
}

}  // namespace
}  // namespace rigmap
