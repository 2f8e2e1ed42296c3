// Which keyframes look alike, by their visual words alone.
#pragma once

#include <utility>
#include <vector>

#include "matching/internal/vocabulary.h"

namespace rigmap {

// An inverted file of tf-idf weights (Sivic and Zisserman 2003). 8 bytes per different word of a
// place; a query costs the places that share each of its words.
class PlaceIndex {
 public:
  // `words_of_places[p]` are the words that place p shows, in any order.
  PlaceIndex(const std::vector<std::vector<int>>& words_of_places, int word_count);

  // Cosine of the weighted words of `place` with those of each place, 0 to 1.
  std::vector<float> Likeness(int place) const;

 private:
  struct Entry {
    int index = 0;  // of a place or a word
    float weight = 0.0F;
  };
  std::vector<std::vector<Entry>> places_;  // words of each place, unit length
  std::vector<std::vector<Entry>> words_;   // places that show each word
};

}  // namespace rigmap
