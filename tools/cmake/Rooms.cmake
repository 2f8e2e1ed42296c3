# One static library per room, one test program per room.

add_library(rigmap_flags INTERFACE)
target_include_directories(rigmap_flags INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
# Off: members with defaults need no initialiser, and GCC 12 takes std::optional of an Eigen vector
# (and <regex> under the sanitizers) for uninitialised.
target_compile_options(rigmap_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
                       -Wno-missing-field-initializers -Wno-maybe-uninitialized)
if(RIGMAP_WARNINGS_AS_ERRORS)
  target_compile_options(rigmap_flags INTERFACE -Werror)
endif()
if(RIGMAP_SANITIZE)
  target_compile_options(rigmap_flags INTERFACE -fsanitize=address,undefined
                         -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  target_link_options(rigmap_flags INTERFACE -fsanitize=address,undefined)
endif()

# add_room(NAME SOURCES a.cc ... [PUBLIC lib ...] [PRIVATE lib ...])
# Makes the static library rigmap_NAME. PUBLIC only for what its headers include.
function(add_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(rigmap_${name} STATIC ${ROOM_SOURCES})
  target_link_libraries(rigmap_${name} PUBLIC rigmap_flags ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
endfunction()

# add_room_test(NAME SOURCES a_test.cc ... [LINK lib ...])
# Makes the test program NAME_test and registers each of its tests with CTest.
function(add_room_test name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name}_test ${ROOM_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${ROOM_LINK} GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${name}_test DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
endfunction()
