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

# add_room_test(NAME SOURCES a_test.cc ... [LINK lib ...])
# Makes the test program NAME_test and registers each of its tests with CTest.
function(add_room_test name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name}_test ${ROOM_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${ROOM_LINK} GTest::gmock GTest::gtest_main)
  target_precompile_headers(${name}_test REUSE_FROM rigmap_precompiled_tests)
  gtest_discover_tests(${name}_test DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
endfunction()
