# One static library per room, one test program per room.

add_library(rigmap_flags INTERFACE)
target_include_directories(rigmap_flags INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
# Off: members with defaults need no initialiser, GCC 12 takes std::optional of an Eigen vector
# (and <regex> under the sanitizers) for uninitialised; a file compiled in a batch is to it a
# header, whose members may not be of a file-local type.
target_compile_options(rigmap_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
                       -Wno-missing-field-initializers -Wno-maybe-uninitialized
                       -Wno-subobject-linkage)
if(RIGMAP_WARNINGS_AS_ERRORS)
  target_compile_options(rigmap_flags INTERFACE -Werror)
endif()
if(RIGMAP_SANITIZE)
  target_compile_options(rigmap_flags INTERFACE -fsanitize=address,undefined
                         -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  target_link_options(rigmap_flags INTERFACE -fsanitize=address,undefined)
endif()

# What nearly every file includes, parsed once; with tests what nearly every test includes. A file
# still names what it uses: builds with -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON must work.
add_library(rigmap_precompiled OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cc)
target_link_libraries(rigmap_precompiled PRIVATE rigmap_flags Eigen3::Eigen)
target_precompile_headers(rigmap_precompiled PRIVATE ${CMAKE_CURRENT_LIST_DIR}/precompiled.h)
if(RIGMAP_BUILD_TESTS)
  add_library(rigmap_precompiled_tests OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cc)
  target_link_libraries(rigmap_precompiled_tests PRIVATE rigmap_flags Eigen3::Eigen GTest::gmock)
  target_precompile_headers(rigmap_precompiled_tests PRIVATE
                            ${CMAKE_CURRENT_LIST_DIR}/precompiled_tests.h)
endif()

# add_room(NAME SOURCES a.cc ... [PUBLIC lib ...] [PRIVATE lib ...])
# Makes the static library rigmap_NAME. PUBLIC only for what its headers include.
function(add_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(rigmap_${name} STATIC ${ROOM_SOURCES})
  target_link_libraries(rigmap_${name} PUBLIC rigmap_flags ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
  target_precompile_headers(rigmap_${name} REUSE_FROM rigmap_precompiled)
endfunction()

# add_room_test(NAME SOURCES a_test.cc ... [LINK lib ...] [APART pattern ...] [SLOW pattern ...])
# Makes the test program NAME_test. CTest runs it as one process, so that what its suites set up is
# set up once. Patterns are GoogleTest's: the tests of each run in an entry of their own, so that the
# processors share what takes long; with the label slow, which tools/test leaves out unless it is
# given --all, where the pattern is a SLOW one. A test fits one pattern only.
function(add_room_test name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK;APART;SLOW" ${ARGN})
  add_executable(${name}_test ${ROOM_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${ROOM_LINK} GTest::gmock GTest::gtest_main)
  target_precompile_headers(${name}_test REUSE_FROM rigmap_precompiled_tests)

  # What no pattern fits, thus also a test whose name changed, is left to the first entry.
  list(JOIN ROOM_APART ":" apart)
  list(JOIN ROOM_SLOW ":" slow)
  add_test(NAME ${name} COMMAND ${name}_test --gtest_filter=-${apart}:${slow})
  set(entries ${name})
  foreach(pattern IN LISTS ROOM_APART ROOM_SLOW)
    string(REGEX REPLACE "[.*]+$" "" entry ${name}.${pattern})
    add_test(NAME ${entry} COMMAND ${name}_test --gtest_filter=${pattern})
    # The long ones first, lest one processor be left waiting for the other.
    set_tests_properties(${entry} PROPERTIES COST 1000)
    if(pattern IN_LIST ROOM_SLOW)
      set_tests_properties(${entry} PROPERTIES LABELS slow)
    endif()
    list(APPEND entries ${entry})
  endforeach()
  set_tests_properties(${entries} PROPERTIES TIMEOUT 1800
                       FAIL_REGULAR_EXPRESSION "Running 0 tests")
endfunction()

# add_code_identities(NAME [UNIT])
# Makes the static library rigmap_NAME with the hashes of the sources (pipeline/code_identity.h), as
# they are when it is built. That of UNIT is made to differ.
function(add_code_identities name)
  set(table ${PROJECT_BINARY_DIR}/${name}.cc)
  add_custom_target(write_${name}
    COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D OUTPUT=${table}
            -D VERSION=${PROJECT_VERSION} -D SALTED=${ARGN} -P ${PROJECT_SOURCE_DIR}/tools/cmake/WriteCodeIdentities.cmake
    BYPRODUCTS ${table})
  add_library(rigmap_${name} STATIC ${table})
  add_dependencies(rigmap_${name} write_${name})
  target_link_libraries(rigmap_${name} PUBLIC rigmap_flags rigmap_pipeline)
endfunction()
