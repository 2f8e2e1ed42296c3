#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(DisjointSets, EachElementIsItsOwnAtFirst) {
  DisjointSets sets(5);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(sets.Root(i), i);
}

TEST(DisjointSets, AUnionKeepsTheRootItIsTold) {
  DisjointSets sets(4);
  sets.Unite(3, 1);
  EXPECT_EQ(sets.Root(1), 3);
  sets.Unite(2, 3);
  for (const int i : {1, 2, 3}) EXPECT_EQ(sets.Root(i), 2);
  EXPECT_EQ(sets.Root(0), 0);
}

// Against the plain way: every element carries its set's number, and a union renumbers.
TEST(DisjointSets, AgreesWithRenumbering) {
  constexpr int kElements = 200, kUnions = 150;
  SeededRandom random;
  DisjointSets sets(kElements);
  std::vector<int> numbers(kElements);
  for (int i = 0; i < kElements; ++i) numbers[i] = i;
  for (int k = 0; k < kUnions; ++k) {
    const int a = sets.Root(static_cast<int>(random.Uniform(0.0, kElements - 1e-9)));
    const int b = sets.Root(static_cast<int>(random.Uniform(0.0, kElements - 1e-9)));
    if (a == b) continue;
    sets.Unite(a, b);
    const int kept = numbers[a], gone = numbers[b];
    for (int& number : numbers) number = number == gone ? kept : number;
  }
  for (int i = 0; i < kElements; ++i) {
    EXPECT_EQ(sets.Root(sets.Root(i)), sets.Root(i));
    for (int j = 0; j < i; ++j) {
      EXPECT_EQ(sets.Root(i) == sets.Root(j), numbers[i] == numbers[j]) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace rigmap
