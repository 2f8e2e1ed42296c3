# Compiles through ccache where it is installed, unless another launcher was asked for.
if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(RIGMAP_CCACHE ccache)
  mark_as_advanced(RIGMAP_CCACHE)
  if(RIGMAP_CCACHE)
    # Without these ccache takes no file that uses a precompiled header.
    set(CMAKE_CXX_COMPILER_LAUNCHER
        ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${RIGMAP_CCACHE})
    set(CMAKE_C_COMPILER_LAUNCHER ${RIGMAP_CCACHE})
  endif()
endif()
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
endif()
