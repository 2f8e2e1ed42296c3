#include "export/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <istream>
#include <sstream>

#include "core/error.h"

namespace rigmap {
namespace {

struct NamedType {
  const char* name;
  const char* sized_name;
  PlyType type;
  std::size_t bytes;
};

constexpr std::array<NamedType, 8> kTypes{{{"char", "int8", PlyType::kInt8, 1},
                                           {"uchar", "uint8", PlyType::kUint8, 1},
                                           {"short", "int16", PlyType::kInt16, 2},
                                           {"ushort", "uint16", PlyType::kUint16, 2},
                                           {"int", "int32", PlyType::kInt32, 4},
                                           {"uint", "uint32", PlyType::kUint32, 4},
                                           {"float", "float32", PlyType::kFloat, 4},
                                           {"double", "float64", PlyType::kDouble, 8}}};

// Takes the header line by line; each complaint is a sentence without the file's name.
class HeaderParser {
 public:
  void Take(const std::string& line) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "format") TakeFormat(words);
    if (keyword == "element") TakeElement(words);
    if (keyword == "property" && elements_ == 1) TakeProperty(words);
  }

  PlyHeader Finished() const {
    if (!format_seen_) throw DataError("expected a line 'format binary_little_endian 1.0'");
    if (elements_ == 0) throw DataError("expected an element 'vertex', found none");
    return header_;
  }

 private:
  void TakeFormat(std::istringstream& words) {
    std::string format;
    words >> format;
    if (format != "binary_little_endian") {
      throw DataError(fmt::format("expected format binary_little_endian, found '{}'", format));
    }
    format_seen_ = true;
  }

  void TakeElement(std::istringstream& words) {
    if (++elements_ > 1) return;
    std::string name;
    if (!(words >> name >> header_.vertex_count) || name != "vertex") {
      throw DataError(
          fmt::format("expected 'vertex' and its count as first element, found '{}'", name));
    }
  }

  void TakeProperty(std::istringstream& words) {
    std::string type, name;
    words >> type >> name;
    const auto known = std::find_if(kTypes.begin(), kTypes.end(), [&](const NamedType& candidate) {
      return type == candidate.name || type == candidate.sized_name;
    });
    if (known == kTypes.end() || name.empty()) {
      throw DataError(fmt::format("expected a property of fixed size, found '{} {}'", type, name));
    }
    header_.properties.push_back({name, known->type, header_.row_bytes});
    header_.row_bytes += known->bytes;
  }

  PlyHeader header_;
  int elements_ = 0;
  bool format_seen_ = false;
};

template <class Scalar>
double Load(const char* bytes) {
  Scalar value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

}  // namespace

const PlyProperty* PlyHeader::Find(std::string_view name) const {
  const auto it = std::find_if(properties.begin(), properties.end(),
                               [&](const PlyProperty& property) { return property.name == name; });
  return it == properties.end() ? nullptr : &*it;
}

PlyHeader ReadPlyHeader(std::istream& stream, const std::string& name) {
  HeaderParser parser;
  std::string line;
  try {
    for (bool first = true; std::getline(stream, line); first = false) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (first && line != "ply") throw DataError("expected a PLY file, found no line 'ply'");
      if (line == "end_header") return parser.Finished();
      parser.Take(line);
    }
    throw DataError("expected 'end_header', found the end of the file");
  } catch (const DataError& error) {
    throw DataError(fmt::format("{}: {}", name, error.what()));
  }
}

double PlyValue(const PlyProperty& property, const char* row) {
  const char* bytes = row + property.offset;
  switch (property.type) {
    case PlyType::kInt8:
      return Load<std::int8_t>(bytes);
    case PlyType::kUint8:
      return Load<std::uint8_t>(bytes);
    case PlyType::kInt16:
      return Load<std::int16_t>(bytes);
    case PlyType::kUint16:
      return Load<std::uint16_t>(bytes);
    case PlyType::kInt32:
      return Load<std::int32_t>(bytes);
    case PlyType::kUint32:
      return Load<std::uint32_t>(bytes);
    case PlyType::kFloat:
      return Load<float>(bytes);
    case PlyType::kDouble:
      return Load<double>(bytes);
  }
  return 0.0;
}

}  // namespace rigmap
