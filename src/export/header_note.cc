#include "export/header_note.h"

#include <fmt/format.h>

#include <fstream>
#include <ostream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

constexpr std::string_view kNoteStart = "not trusted";  // by which a note is known

// The lines before a note, the note's line if there is one, and where the rest begins.
struct Head {
  std::string before, note;
  std::streamoff rest = 0;
};

Head ReadHead(std::istream& stream, std::string_view mark, int lines_before) {
  Head head;
  std::string line;
  for (int i = 0; i < lines_before && std::getline(stream, line); ++i) head.before += line + '\n';
  head.rest = stream.tellg();
  const std::string start = std::string(mark) + std::string(kNoteStart);
  std::string found(start.size(), '\0');
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  if (stream.gcount() == static_cast<std::streamsize>(start.size()) && found == start &&
      std::getline(stream, line)) {
    head.note = found + line + '\n';
    head.rest += static_cast<std::streamoff>(head.note.size());
  }
  stream.clear();
  return head;
}

}  // namespace

void SetHeaderNote(const std::filesystem::path& path, const std::string& note) {
  const bool is_ply = path.extension() == ".ply";
  const std::string_view mark = is_ply ? "comment " : "# ";
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(fmt::format("{}: cannot be read", path.string()));
  const Head head = ReadHead(file, mark, is_ply ? 2 : 0);
  const std::string wanted = note.empty() ? "" : fmt::format("{}{}\n", mark, note);
  if (head.note == wanted) return;
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream << head.before << wanted;
    file.seekg(head.rest);
    if (file.peek() != std::ifstream::traits_type::eof()) stream << file.rdbuf();
    if (!file) throw DataError(fmt::format("{}: cannot be read", path.string()));
  });
}

}  // namespace rigmap
