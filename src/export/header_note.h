// A note in the header of a file that lies written already: what its readers have to know.
#pragma once

#include <filesystem>
#include <string>

namespace rigmap {

// Makes `note`, a line without line breaks that begins with "not trusted", the file's note in place
// of the one it has, or takes that away where `note` is empty. A PLY file bears it as the comment
// behind its format, any other as its first line, behind '#'. Nothing else of the file changes, and
// one that is as it should be is not touched; else it is replaced atomically. Memory does not grow
// with the file. Throws DataError naming the file.
void SetHeaderNote(const std::filesystem::path& path, const std::string& note);

}  // namespace rigmap
