#include "matching/internal/place_index.h"

#include <cmath>
#include <map>

namespace rigmap {

PlaceIndex::PlaceIndex(const std::vector<std::vector<int>>& words_of_places, int word_count)
    : places_(words_of_places.size()), words_(static_cast<std::size_t>(word_count)) {
  std::vector<int> places_with(static_cast<std::size_t>(word_count), 0);
  for (std::size_t p = 0; p < places_.size(); ++p) {
    std::map<int, int> counts;
    for (const int word : words_of_places[p]) ++counts[word];
    for (const auto& [word, count] : counts) {
      places_[p].push_back({word, static_cast<float>(count)});
      ++places_with[word];
    }
  }
  const auto count = static_cast<float>(places_.size());
  for (std::size_t p = 0; p < places_.size(); ++p) {
    float square = 0.0F;
    for (Entry& entry : places_[p]) {
      entry.weight *= std::log(count / static_cast<float>(places_with[entry.index]));
      square += entry.weight * entry.weight;
    }
    for (Entry& entry : places_[p]) {
      if (square > 0.0F) entry.weight /= std::sqrt(square);
      words_[entry.index].push_back({static_cast<int>(p), entry.weight});
    }
  }
}

std::vector<float> PlaceIndex::Likeness(int place) const {
  std::vector<float> likeness(places_.size(), 0.0F);
  for (const Entry& of_place : places_[place]) {
    for (const Entry& entry : words_[of_place.index]) {
      likeness[entry.index] += of_place.weight * entry.weight;
    }
  }
  return likeness;
}

}  // namespace rigmap
