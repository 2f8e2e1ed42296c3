#include "core/artefact.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <xxhash.h>

#include <array>
#include <fstream>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

constexpr const char* kEndMark = "end.";

std::string Hexadecimal(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string FirstLine(const std::string& key) { return fmt::format("rigmap artefact {}", key); }

}  // namespace

std::string HashText(std::string_view text) {
  return Hexadecimal(XXH3_128bits(text.data(), text.size()));
}

std::string HashFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  std::array<char, 1 << 16> buffer;
  while (stream.read(buffer.data(), buffer.size()), stream.gcount() > 0) {
    XXH3_128bits_update(&state, buffer.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.eof()) throw DataError(fmt::format("{}: cannot read", path.string()));
  return Hexadecimal(XXH3_128bits_digest(&state));
}

namespace artefact_detail {

void Write(const std::filesystem::path& path, const std::string& key,
           const std::function<void(std::ostream&)>& body) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream << FirstLine(key) << '\n';
    try {
      body(stream);
    } catch (const cereal::Exception&) {
      // A full disk: cereal says so, but not of which file.
      stream.setstate(std::ios::badbit);
    }
    stream << kEndMark;
  });
}

bool Read(const std::filesystem::path& path, const std::string& key,
          const std::function<void(std::istream&)>& body) {
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  if (!std::getline(stream, line) || line != FirstLine(key)) return false;
  try {
    body(stream);
    std::string end(std::char_traits<char>::length(kEndMark), '\0');
    stream.read(end.data(), static_cast<std::streamsize>(end.size()));
    if (stream && end == kEndMark) return true;
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
  std::string end(std::char_traits<char>::length(kEndMark), '\0');
  stream.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  stream.read(end.data(), static_cast<std::streamsize>(end.size()));
  return stream && end == kEndMark;
}

}  // namespace rigmap
