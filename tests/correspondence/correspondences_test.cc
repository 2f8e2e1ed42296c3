#include "scene/correspondences.h"

#include <gtest/gtest.h>

#include <cereal/archives/binary.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>

namespace rigmap {
namespace {

TEST(Correspondences, ComeBackFromAnArchive) {
  Correspondences written;
  written.features = {{{.left = {1.25, -2.5}, .right = Eigen::Vector2d(0.5, 3.0), .size = 4.5F}},
                      {},
                      {{.left = {7.0, 8.0}, .right = std::nullopt, .size = 2.0F}}};
  written.pairs = {{0, 2, {{0U, 0U}}}};
  std::stringstream stream;
  cereal::BinaryOutputArchive{stream}(written);
  Correspondences read;
  cereal::BinaryInputArchive{stream}(read);
  ASSERT_EQ(read.features.size(), 3u);
  EXPECT_EQ(read.features[0].at(0).left, written.features[0][0].left);
  EXPECT_EQ(read.features[0][0].right, written.features[0][0].right);
  EXPECT_EQ(read.features[0][0].size, 4.5F);
  EXPECT_TRUE(read.features[1].empty());
  EXPECT_FALSE(read.features[2].at(0).right);
  ASSERT_EQ(read.pairs.size(), 1u);
  EXPECT_EQ(read.pairs[0].a, 0);
  EXPECT_EQ(read.pairs[0].b, 2);
  EXPECT_EQ(read.pairs[0].matches, written.pairs[0].matches);
}

TEST(FeatureRef, IsOrderedByFrameThenFeature) {
  EXPECT_LT((FeatureRef{1, 9}), (FeatureRef{2, 0}));
  EXPECT_LT((FeatureRef{1, 2}), (FeatureRef{1, 3}));
  EXPECT_EQ((FeatureRef{1, 2}), (FeatureRef{1, 2}));
}

}  // namespace
}  // namespace rigmap
