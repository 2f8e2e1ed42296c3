// Which code made a result: hashes of the sources, taken when the program was built.
#pragma once

#include <source_location>
#include <span>
#include <string>
#include <string_view>

namespace rigmap {

// A room of src/ ("src/fusion"), or a source and its header in workflows/stages/ without their
// endings ("workflows/stages/fusion"). The hash covers its own sources and headers and those of all
// rooms that it includes, directly or by way of others.
struct CodeIdentity {
  std::string_view unit;
  std::string_view hash;
};

// Of this program, in order of units. Written by tools/cmake/WriteCodeIdentities.cmake and linked
// by each program, so that a test can link another.
std::span<const CodeIdentity> CodeIdentities();

// "0.1.0 (v0.1.0-3-gabcdef)": the release and, where it is known, `git describe` of the tree that
// was built. For people, no key holds it.
std::string_view SourceVersion();

// The hash of the unit that calls. Throws std::logic_error if it is none.
std::string_view CodeHere(const std::source_location& here = std::source_location::current());

}  // namespace rigmap
