# The libraries of PCL that rigmap links, as Pcl::registration. PCL's own package file would ask for
# all that any of its modules may use, VTK and Qt among it, and link that.
find_path(PCL_INCLUDE_DIR pcl/pcl_config.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl-1.15)
set(pcl_wanted registration features filters search kdtree octree sample_consensus common)
set(pcl_variables "")
foreach(name IN LISTS pcl_wanted)
  find_library(PCL_${name}_LIBRARY pcl_${name})
  list(APPEND pcl_variables PCL_${name}_LIBRARY)
  list(APPEND PCL_FOUND_LIBRARIES ${PCL_${name}_LIBRARY})
endforeach()
if(PCL_INCLUDE_DIR)
  file(STRINGS ${PCL_INCLUDE_DIR}/pcl/pcl_config.h pcl_version REGEX "define PCL_VERSION_PRETTY")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" PclLibraries_VERSION "${pcl_version}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PclLibraries REQUIRED_VARS PCL_INCLUDE_DIR ${pcl_variables}
                                  VERSION_VAR PclLibraries_VERSION)
mark_as_advanced(PCL_INCLUDE_DIR ${pcl_variables})
if(PclLibraries_FOUND AND NOT TARGET Pcl::registration)
  add_library(Pcl::registration INTERFACE IMPORTED)
  target_include_directories(Pcl::registration SYSTEM INTERFACE ${PCL_INCLUDE_DIR})
  target_link_libraries(Pcl::registration INTERFACE ${PCL_FOUND_LIBRARIES} Eigen3::Eigen)
endif()
