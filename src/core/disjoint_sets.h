// Elements that belong together, directly or by way of others.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace rigmap {

// Union-find over 0 .. count - 1 with path halving (Tarjan and van Leeuwen 1984). Each set is known
// by one of its elements, its root. The caller says whose root a union keeps, so that roots can
// mean something (the first element, the one that holds the data). Not thread-safe, Root neither.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  int Root(int element) {
    while (parents_[element] != element) {
      element = parents_[element] = parents_[parents_[element]];
    }
    return element;
  }

  // Both must be roots; `kept` is that of the union.
  void Unite(int kept, int other) { parents_[other] = kept; }

 private:
  std::vector<int> parents_;
};

}  // namespace rigmap
