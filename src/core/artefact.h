// What a stage leaves behind, so that the next run need not do it again: a file whose name tells
// the stage and whose first line holds the key of the inputs and options it was made from. It ends
// with the hash of what lies between.
#pragma once

#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

namespace rigmap {

// 128-bit hash (XXH3) as 32 hexadecimal digits.
std::string HashText(std::string_view text);
// The same of a file's bytes, read piece by piece. Throws DataError when it cannot be read.
std::string HashFile(const std::filesystem::path& path);

namespace artefact_detail {
void Write(const std::filesystem::path& path, const std::string& key,
           const std::function<void(std::ostream&)>& body);
bool Read(const std::filesystem::path& path, const std::string& key,
          const std::function<void(std::istream&)>& body);
}  // namespace artefact_detail

// True if `path` holds a whole artefact made with `key`. Reads its first line and its end only.
bool HasArtefact(const std::filesystem::path& path, const std::string& key);

// Written to a temporary and renamed: a reader never sees half of it. Values are stored through
// cereal in this machine's byte order: an artefact is not for exchange. The key has to change with
// the shape of the type.
template <class Value>
void WriteArtefact(const std::filesystem::path& path, const std::string& key, const Value& value) {
  artefact_detail::Write(path, key, [&](std::ostream& stream) {
    cereal::BinaryOutputArchive archive(stream);
    archive(value);
  });
}

// The value, or nothing if there is none with this key (or it is damaged).
template <class Value>
std::optional<Value> ReadArtefact(const std::filesystem::path& path, const std::string& key) {
  Value value;
  const bool found = artefact_detail::Read(path, key, [&](std::istream& stream) {
    cereal::BinaryInputArchive archive(stream);
    archive(value);
  });
  return found ? std::optional<Value>(std::move(value)) : std::nullopt;
}

}  // namespace rigmap
