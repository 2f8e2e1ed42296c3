// The vertices of a PLY file row by row, whatever their properties.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "export/ply_header.h"

namespace rigmap {

// Holds a quarter of a megabyte of the file at a time. Every complaint is a DataError naming the
// file.
class PlyRows {
 public:
  // Throws for anything but a binary little-endian PLY whose first element is `vertex`, and for a
  // file that ends too early.
  explicit PlyRows(const std::filesystem::path& path);

  std::uint64_t size() const { return header_.vertex_count; }
  const std::string& name() const { return name_; }  // of the file
  const PlyProperty* Find(const char* name) const { return header_.Find(name); }
  // As Find, but throws where there is no such property.
  const PlyProperty& At(const char* name) const;
  using Columns = std::array<const PlyProperty*, 3>;
  Columns At(const std::array<const char*, 3>& names) const;

  // The next row, for PlyValue; valid until the next call. To be called size() times at most.
  const char* Next();
  // Three properties of the row that Next gave last, as float; throws unless they are finite.
  Eigen::Vector3f FinitePoint(const Columns& columns) const;

 private:
  std::string name_;
  std::ifstream stream_;
  PlyHeader header_;
  std::vector<char> block_;
  const char* row_ = nullptr;
  std::size_t next_in_block_ = 0;  // bytes
  std::uint64_t rows_read_ = 0;    // into blocks, so far
};

}  // namespace rigmap
