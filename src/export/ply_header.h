// The head of a PLY file as far as this project needs it: the properties of its first element.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace rigmap {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  std::size_t offset = 0;  // bytes from the start of the row
};

struct PlyHeader {
  std::uint64_t vertex_count = 0;
  std::size_t row_bytes = 0;
  std::vector<PlyProperty> properties;  // of the vertices

  const PlyProperty* Find(std::string_view name) const;
};

// Reads up to and with "end_header"; the stream then stands at the first vertex. `name` stands for
// the file in messages. Throws DataError unless it is a binary little-endian PLY whose first
// element is `vertex` with properties of fixed size.
PlyHeader ReadPlyHeader(std::istream& stream, const std::string& name);

// The property's value in the row that starts at `row`.
double PlyValue(const PlyProperty& property, const char* row);

}  // namespace rigmap
