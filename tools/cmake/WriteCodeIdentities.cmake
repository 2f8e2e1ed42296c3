# cmake -D SOURCE_DIR=... -D OUTPUT=FILE.cc -D VERSION=... [-D SALTED=unit] -P WriteCodeIdentities.cmake
#
# Writes the table of pipeline/code_identity.h: for each unit (a room of src/, a file of
# workflows/stages/ and its header) a hash of its own files and of those of every unit that it
# includes, directly or by way of others. OUTPUT is only touched if something changed.
# SALTED names a unit whose hash is made to differ, for tests that want another algorithm.
cmake_minimum_required(VERSION 3.25)

# Own files of each unit -> UNITS, FILES_<unit>.
set(UNITS "")
file(GLOB rooms LIST_DIRECTORIES true RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/src/*)
foreach(room IN LISTS rooms)
  file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${room}/*.h ${SOURCE_DIR}/${room}/*.cc)
  list(APPEND UNITS ${room})
  set(FILES_${room} ${files})
endforeach()
file(GLOB glue RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/workflows/stages/*)
foreach(file IN LISTS glue)
  string(REGEX REPLACE "\\.[a-z]+$" "" unit ${file})
  list(APPEND UNITS ${unit})
  list(APPEND FILES_${unit} ${file})
endforeach()
list(REMOVE_DUPLICATES UNITS)
list(SORT UNITS)

# What each unit's files are, and which other units they include -> OWN_<unit>, DIRECT_<unit>.
foreach(unit IN LISTS UNITS)
  set(own "")
  set(direct "")
  list(SORT FILES_${unit})
  foreach(file IN LISTS FILES_${unit})
    file(SHA256 ${SOURCE_DIR}/${file} hash)
    string(APPEND own "${file} ${hash}\n")
    file(STRINGS ${SOURCE_DIR}/${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]*\"[^\"]+/[^\"]+\"")
    foreach(line IN LISTS includes)
      string(REGEX REPLACE ".*\"([^\"]+)\".*" "\\1" header "${line}")
      string(REGEX REPLACE "\\.h$" "" stem "${header}")
      string(REGEX REPLACE "/.*" "" room "${header}")
      if(stem IN_LIST UNITS)
        list(APPEND direct ${stem})
      elseif("src/${room}" IN_LIST UNITS)
        list(APPEND direct src/${room})
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES direct)
  set(DIRECT_${unit} ${direct})
  if(unit STREQUAL "${SALTED}")
    string(APPEND own "salted\n")
  endif()
  set(OWN_${unit} "${own}")
endforeach()

set(rows "")
foreach(unit IN LISTS UNITS)
  set(reached ${unit})
  set(open ${unit})
  while(open)
    list(POP_FRONT open next)
    foreach(other IN LISTS DIRECT_${next})
      if(NOT other IN_LIST reached)
        list(APPEND reached ${other})
        list(APPEND open ${other})
      endif()
    endforeach()
  endwhile()
  list(SORT reached)
  set(all "")
  foreach(other IN LISTS reached)
    string(APPEND all "${OWN_${other}}")
  endforeach()
  string(SHA256 hash "${all}")
  string(SUBSTRING ${hash} 0 32 hash)
  string(APPEND rows "    {\"${unit}\", \"${hash}\"},\n")
endforeach()

execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --tags
                OUTPUT_VARIABLE version ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(version)
  set(version " (${version})")
endif()

set(text "// Made by tools/cmake/WriteCodeIdentities.cmake.
#include \"pipeline/code_identity.h\"

namespace rigmap {

std::span<const CodeIdentity> CodeIdentities() {
  static constexpr CodeIdentity kIdentities[] = {
${rows}  };
  return kIdentities;
}

std::string_view SourceVersion() { return \"${VERSION}${version}\"; }

}  // namespace rigmap
")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
