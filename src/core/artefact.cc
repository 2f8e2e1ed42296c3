#include "core/artefact.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

constexpr std::string_view kEndMark = "end.";
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kPiece = 1 << 16;  // bytes

std::string Hexadecimal(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

class RunningHash {
 public:
  RunningHash() { XXH3_128bits_reset(&state_); }
  void Add(const char* bytes, std::streamsize count) {
    XXH3_128bits_update(&state_, bytes, static_cast<std::size_t>(count));
  }
  std::string Digits() const { return Hexadecimal(XXH3_128bits_digest(&state_)); }

 private:
  XXH3_state_t state_;
};

// Hands on to another buffer what is written, and takes its hash.
class HashedBuffer : public std::streambuf {
 public:
  explicit HashedBuffer(std::streambuf& to) : to_(to), piece_(kPiece) { Empty(); }
  // Of all that was written.
  std::string Digits() {
    sync();
    return hash_.Digits();
  }

 protected:
  int_type overflow(int_type next) override {
    if (sync() != 0) return traits_type::eof();
    return traits_type::eq_int_type(next, traits_type::eof())
               ? traits_type::not_eof(next)
               : sputc(traits_type::to_char_type(next));
  }
  int sync() override {
    const std::streamsize count = pptr() - pbase();
    hash_.Add(pbase(), count);
    const bool is_written = to_.sputn(pbase(), count) == count;
    Empty();
    return is_written ? 0 : -1;
  }

 private:
  void Empty() { setp(piece_.data(), piece_.data() + piece_.size()); }

  std::streambuf& to_;
  std::vector<char> piece_;
  RunningHash hash_;
};

// What follows the body: its hash and a mark.
std::string EndOf(const std::string& digits) { return digits + std::string(kEndMark); }

// The last bytes of a file, as many as EndOf has; empty where it is shorter.
std::string LastBytes(std::istream& stream) {
  std::string end(kHashDigits + kEndMark.size(), '\0');
  stream.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  stream.read(end.data(), static_cast<std::streamsize>(end.size()));
  return stream ? end : "";
}

// Whether the bytes from where the stream stands up to the end's have the hash that the end tells.
// It stands there again afterwards.
bool IsWhole(std::istream& stream) {
  const std::streamoff begin = stream.tellg();
  const std::string end = LastBytes(stream);
  std::streamoff left = stream.tellg() - static_cast<std::streamoff>(end.size()) - begin;
  if (end.empty() || left < 0) return false;
  stream.seekg(begin);
  RunningHash hash;
  std::vector<char> piece(kPiece);
  while (left > 0 && stream.read(piece.data(), std::min<std::streamoff>(left, kPiece))) {
    hash.Add(piece.data(), stream.gcount());
    left -= stream.gcount();
  }
  stream.seekg(begin);
  return left == 0 && stream && end == EndOf(hash.Digits());
}

std::string FirstLine(const std::string& key) { return fmt::format("rigmap artefact {}", key); }

}  // namespace

std::string HashText(std::string_view text) {
  return Hexadecimal(XXH3_128bits(text.data(), text.size()));
}

std::string HashFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  RunningHash hash;
  std::array<char, kPiece> buffer;
  while (stream.read(buffer.data(), buffer.size()), stream.gcount() > 0) {
    hash.Add(buffer.data(), stream.gcount());
  }
  if (!stream.eof()) throw DataError(fmt::format("{}: cannot read", path.string()));
  return hash.Digits();
}

namespace artefact_detail {

void Write(const std::filesystem::path& path, const std::string& key,
           const std::function<void(std::ostream&)>& body) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream << FirstLine(key) << '\n';
    HashedBuffer buffer(*stream.rdbuf());
    std::ostream hashed(&buffer);
    try {
      body(hashed);
    } catch (const cereal::Exception&) {
      hashed.setstate(std::ios::badbit);
    }
    // A full disk: cereal says so, but not of which file.
    if (!hashed.flush()) stream.setstate(std::ios::badbit);
    stream << EndOf(buffer.Digits());
  });
}

bool Read(const std::filesystem::path& path, const std::string& key,
          const std::function<void(std::istream&)>& body) {
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  if (!std::getline(stream, line) || line != FirstLine(key)) return false;
  try {
    if (IsWhole(stream)) {
      body(stream);
      if (stream) return true;
    }
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", path.string(), error.what());
  }
  spdlog::warn("{}: damaged", path.string());
  return false;
}

}  // namespace artefact_detail

bool HasArtefact(const std::filesystem::path& path, const std::string& key) {
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  if (!std::getline(stream, line) || line != FirstLine(key)) return false;
  return LastBytes(stream).ends_with(kEndMark);
}

}  // namespace rigmap
