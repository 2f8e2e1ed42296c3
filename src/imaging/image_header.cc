#include "imaging/internal/image_header.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>
#include <string_view>

namespace rigmap {
namespace {

using std::string_view_literals::operator""sv;

// A file read at any place; what lies behind its end is absent.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& path) : stream_(path, std::ios::binary) {
    std::error_code code;
    const auto size = std::filesystem::file_size(path, code);
    if (!code && stream_) size_ = static_cast<std::int64_t>(size);
  }

  std::int64_t size() const { return size_; }

  std::string At(std::int64_t begin, std::int64_t count) {
    if (begin < 0 || begin > size_) return {};
    std::string bytes(static_cast<std::size_t>(std::min(count, size_ - begin)), '\0');
    stream_.clear();
    stream_.seekg(begin);
    stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream_.gcount()));
    return bytes;
  }

  std::optional<std::int64_t> Number(std::int64_t begin, int byte_count, bool big_endian) {
    const std::string bytes = At(begin, byte_count);
    if (std::ssize(bytes) < byte_count) return std::nullopt;
    std::int64_t value = 0;
    for (int i = 0; i < byte_count; ++i) {
      value = (value << 8) | static_cast<unsigned char>(bytes[big_endian ? i : byte_count - 1 - i]);
    }
    return value;
  }

  bool EndsWith(std::string_view mark) {
    constexpr std::int64_t kTailBytes = 1024;
    const std::int64_t begin = std::max<std::int64_t>(0, size_ - kTailBytes);
    return At(begin, size_ - begin).find(mark) != std::string::npos;
  }

 private:
  std::ifstream stream_;
  std::int64_t size_ = 0;
};

// W3C, Portable Network Graphics (2nd edition), 5.3 and 11.2.2: the first chunk is IHDR.
std::optional<ImageHeader> ReadPng(Bytes& file) {
  if (file.At(12, 4) != "IHDR") return std::nullopt;
  const auto width = file.Number(16, 4, true), height = file.Number(20, 4, true),
             bits = file.Number(24, 1, true);
  if (!width || !height || !bits) return std::nullopt;
  return ImageHeader{*width, *height, *bits, file.EndsWith("\0\0\0\0IEND\xae\x42\x60\x82"sv)};
}

// ITU-T T.81, B.1 and B.2.2: the size stands in the frame header, before the first scan.
std::optional<ImageHeader> ReadJpeg(Bytes& file) {
  constexpr int kMaxSegments = 1000;
  std::int64_t at = 2;
  for (int segment = 0; segment < kMaxSegments; ++segment) {
    if (file.Number(at, 1, true) != 0xFF) return std::nullopt;
    const auto marker = file.Number(at + 1, 1, true);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const auto length = file.Number(at + 2, 2, true);
    if (!marker || !length || *length < 2 || *marker == 0xDA) return std::nullopt;
    const bool is_frame =
        *marker >= 0xC0 && *marker <= 0xCF && *marker != 0xC4 && *marker != 0xC8 && *marker != 0xCC;
    if (is_frame) {
      const auto bits = file.Number(at + 4, 1, true), height = file.Number(at + 5, 2, true),
                 width = file.Number(at + 7, 2, true);
      if (!width || !height) return std::nullopt;
      return ImageHeader{*width, *height, *bits, file.EndsWith("\xff\xd9"sv)};
    }
    at += 2 + *length;
  }
  return std::nullopt;
}

// netpbm's pbm(5), pgm(5) and ppm(5): numbers between white space and comments up to line ends.
class PnmNumbers {
 public:
  explicit PnmNumbers(std::string text) : text_(std::move(text)) {}

  std::optional<std::int64_t> Next() {
    while (at_ < text_.size() && (IsSpace() || text_[at_] == '#')) {
      at_ = text_[at_] == '#' ? std::min(text_.find('\n', at_), text_.size()) : at_ + 1;
    }
    constexpr std::size_t kMaxDigits = 9;
    std::int64_t value = 0;
    const std::size_t first = at_;
    for (; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])); ++at_) {
      if (at_ - first == kMaxDigits) return std::nullopt;
      value = 10 * value + (text_[at_] - '0');
    }
    if (at_ == first || at_ == text_.size() || !IsSpace()) return std::nullopt;
    return value;
  }
  std::int64_t Offset() const { return static_cast<std::int64_t>(at_); }

 private:
  bool IsSpace() const { return std::isspace(static_cast<unsigned char>(text_[at_])); }

  std::string text_;
  std::size_t at_ = 2;  // behind the magic number
};

std::optional<ImageHeader> ReadPnm(Bytes& file) {
  constexpr std::int64_t kMaxHeader = 4096;  // with comments
  std::string head = file.At(0, kMaxHeader);
  const char kind = head[1];
  const bool is_bitmap = kind == '1' || kind == '4', is_text = kind <= '3';
  PnmNumbers numbers(std::move(head));
  const auto width = numbers.Next(), height = numbers.Next();
  const auto most = is_bitmap ? std::optional<std::int64_t>(1) : numbers.Next();
  if (!width || !height || !most) return std::nullopt;
  const std::int64_t row_samples = *width * (kind == '3' || kind == '6' ? 3 : 1);
  std::int64_t row_bytes = row_samples;  // as text at least a digit each
  if (kind == '4') row_bytes = (row_samples + 7) / 8;
  const bool is_wide = *most > 255;
  if (!is_text && is_wide) row_bytes *= 2;
  // Nine digits each: a division, since the product may not fit.
  const bool fits = row_bytes == 0 || (file.size() - numbers.Offset() - 1) / row_bytes >= *height;
  return ImageHeader{*width, *height, is_wide ? 16 : 8, fits};
}

// TIFF 6.0 (Adobe 1992), section 2: the tags of the first directory.
class TiffDirectory {
 public:
  explicit TiffDirectory(Bytes& file) : file_(file), big_endian_(file.At(0, 2) == "MM") {
    directory_ = file_.Number(4, 4, big_endian_).value_or(0);
    count_ = file_.Number(directory_, 2, big_endian_).value_or(0);
  }

  // Behind the directory the place of the next one stands.
  bool IsWhole() const { return directory_ + 2 + 12 * count_ + 4 <= file_.size(); }

  std::optional<std::int64_t> Count(int tag) {
    const auto entry = Find(tag);
    return entry ? file_.Number(*entry + 4, 4, big_endian_) : std::nullopt;
  }
  std::optional<std::int64_t> Value(int tag, std::int64_t index = 0) {
    constexpr int kShort = 3, kLong = 4;
    const auto entry = Find(tag);
    if (!entry) return std::nullopt;
    const auto type = file_.Number(*entry + 2, 2, big_endian_), count = Count(tag);
    if ((type != kShort && type != kLong) || !count || index >= *count) return std::nullopt;
    const int byte_count = type == kShort ? 2 : 4;
    // Up to four bytes stand in the entry itself.
    const auto offset = *count * byte_count <= 4 ? std::optional(*entry + 8)
                                                 : file_.Number(*entry + 8, 4, big_endian_);
    return offset ? file_.Number(*offset + index * byte_count, byte_count, big_endian_)
                  : std::nullopt;
  }

 private:
  std::optional<std::int64_t> Find(int tag) {
    for (std::int64_t i = 0; i < count_; ++i) {
      const std::int64_t entry = directory_ + 2 + 12 * i;
      if (file_.Number(entry, 2, big_endian_) == tag) return entry;
    }
    return std::nullopt;
  }

  Bytes& file_;
  bool big_endian_;
  std::int64_t directory_ = 0, count_ = 0;
};

bool HoldsAll(TiffDirectory& directory, std::int64_t file_size, int offsets, int byte_counts) {
  const auto pieces = directory.Count(offsets);
  if (!pieces || *pieces < 1 || directory.Count(byte_counts) != pieces) return false;
  for (std::int64_t i = 0; i < *pieces; ++i) {
    const auto begin = directory.Value(offsets, i), bytes = directory.Value(byte_counts, i);
    if (!begin || !bytes || *begin + *bytes > file_size) return false;
  }
  return true;
}

std::optional<ImageHeader> ReadTiff(Bytes& file) {
  constexpr int kWidth = 256, kHeight = 257, kBitsPerSample = 258, kStripOffsets = 273,
                kStripBytes = 279, kTileOffsets = 324, kTileBytes = 325, kSampleFormat = 339,
                kFloatingPoint = 3;
  TiffDirectory directory(file);
  const auto width = directory.Value(kWidth), height = directory.Value(kHeight);
  if (!width || !height) return std::nullopt;
  return ImageHeader{
      *width, *height, directory.Value(kBitsPerSample).value_or(1),
      directory.IsWhole() && (HoldsAll(directory, file.size(), kStripOffsets, kStripBytes) ||
                              HoldsAll(directory, file.size(), kTileOffsets, kTileBytes)),
      directory.Value(kSampleFormat) == kFloatingPoint};
}

std::optional<ImageHeader> ReadAny(Bytes& file) {
  const std::string head = file.At(0, 8);
  if (head == "\x89PNG\r\n\x1a\n"sv) return ReadPng(file);
  if (head.starts_with("\xff\xd8\xff"sv)) return ReadJpeg(file);
  if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) return ReadTiff(file);
  if (head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6') return ReadPnm(file);
  return std::nullopt;
}

}  // namespace

std::optional<ImageHeader> ReadImageHeader(const std::filesystem::path& path) {
  Bytes file(path);
  const auto header = ReadAny(file);
  if (!header || header->width < 1 || header->height < 1) return std::nullopt;
  return header;
}

}  // namespace rigmap
