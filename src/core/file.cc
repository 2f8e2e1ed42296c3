#include "core/file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr const char* kTemporarySuffix = ".unfinished";

std::filesystem::path TemporaryBeside(const std::filesystem::path& path) {
  return path.parent_path() / (path.filename().string() + kTemporarySuffix);
}

void CreateParent(const std::filesystem::path& path) {
  std::error_code code;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), code);
  if (code) {
    throw DataError(fmt::format("{}: cannot create the folder: {}", path.parent_path().string(),
                                code.message()));
  }
}

void Rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code code;
  std::filesystem::rename(from, to, code);
  if (code) throw DataError(fmt::format("{}: cannot write: {}", to.string(), code.message()));
}

DataError CannotWrite(const std::filesystem::path& path, std::ofstream& stream) {
  if (stream.is_open()) {
    // What the system said last may be about another file; it says it again.
    const int last = std::exchange(errno, 0);
    stream.clear();
    stream.put('\0').flush();
    if (errno == 0) errno = last;
  }
  return DataError(fmt::format("{}: cannot write: {}", path.string(), std::strerror(errno)));
}

// Whoever writes may notice a full disk first, and knows less of it.
void WriteTo(std::ofstream& stream, const std::filesystem::path& path,
             const std::function<void(std::ostream&)>& write) {
  try {
    write(stream);
  } catch (const std::exception&) {
    if (!stream) throw CannotWrite(path, stream);
    throw;
  }
}

// /dev/null is an empty file to many; /dev/zero has no end.
std::string ReadDevice(std::istream& stream, const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::string content(kMostBytes + 1, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  if (content.size() > kMostBytes) {
    throw DataError(
        fmt::format("{}: expected a file, found a device without an end", path.string()));
  }
  return content;
}

}  // namespace

std::string ReadBytes(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw DataError(fmt::format("{}: expected a file, found a folder", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  if (stream && std::filesystem::is_character_file(path, ignored)) return ReadDevice(stream, path);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream) {
    throw DataError(fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  return std::move(text).str();
}

std::string ReadTextFile(const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string content = ReadBytes(path);
  if (!content.starts_with(kByteOrderMark)) return content;
  return content.substr(kByteOrderMark.size());
}

void WriteFileAtomically(const std::filesystem::path& path,
                         const std::function<void(std::ostream&)>& write) {
  CreateParent(path);
  const auto temporary = TemporaryBeside(path);
  try {
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    if (stream) WriteTo(stream, path, write);
    stream.close();
    if (!stream) throw CannotWrite(path, stream);
    Rename(temporary, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

void WriteFolderAtomically(const std::filesystem::path& name,
                           const std::function<void(const std::filesystem::path&)>& fill) {
  // "folder/" names the same as "folder", but has no last part to put something beside.
  const auto path = name.has_filename() ? name : name.parent_path();
  CreateParent(path);
  const auto temporary = TemporaryBeside(path);
  const auto previous = TemporaryBeside(path.string() + ".previous");
  std::error_code ignored;
  std::filesystem::remove_all(temporary, ignored);
  std::filesystem::remove_all(previous, ignored);
  try {
    CreateParent(temporary / "inside");
    fill(temporary);
    // Moved away, not removed in place: nobody may see a half-removed folder either.
    if (std::filesystem::exists(path, ignored)) Rename(path, previous);
    Rename(temporary, path);
    std::filesystem::remove_all(previous, ignored);
  } catch (...) {
    if (!std::filesystem::exists(path, ignored)) std::filesystem::rename(previous, path, ignored);
    std::filesystem::remove_all(temporary, ignored);
    throw;
  }
}

bool IsTemporaryName(const std::string& name) {
  return std::filesystem::path(name).extension() == kTemporarySuffix;
}

}  // namespace rigmap
