// Whole files, read at once and written so that nobody ever sees half of one.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

namespace rigmap {

// Throws DataError naming the path when it cannot be read.
std::string ReadBytes(const std::filesystem::path& path);
// Without the mark of UTF-8 that some editors put before a text.
std::string ReadTextFile(const std::filesystem::path& path);

// Calls `write` on a stream to a temporary file beside `path`, then renames it into place. On any
// failure the old file is left as it was and the temporary is removed; throws DataError, or
// whatever `write` throws. Creates the parent folder.
void WriteFileAtomically(const std::filesystem::path& path,
                         const std::function<void(std::ostream&)>& write);

// The same for a folder: `fill` writes into a temporary sibling, which then takes the place of
// `path`. A previous folder at `path` is removed.
void WriteFolderAtomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path&)>& fill);

// True if `name` is what the two functions above call an unfinished file or folder.
bool IsTemporaryName(const std::string& name);

}  // namespace rigmap
