# cmake --install BUILD --prefix DIR, and cpack for a Debian package: what a node of a cluster needs.
# rigmap finds its rig files in share/rigmap/config above itself (core/config_file.h).
include(GNUInstallDirs)

install(TARGETS rigmap rigmap-simulate RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY config/ DESTINATION share/rigmap/config FILES_MATCHING PATTERN "*.yaml")
install(FILES workflows/Snakefile workflows/job_arguments.py DESTINATION share/rigmap/workflows)
install(PROGRAMS workflows/part-job DESTINATION share/rigmap/workflows)
install(DIRECTORY workflows/profiles DESTINATION share/rigmap/workflows)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rigmap)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "metric trajectories and maps from stereo rovers")
set(CPACK_PACKAGE_CONTACT "rigmap <rigmap@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Libraries by what the programs link; COLMAP is a program.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "colmap (>= 3.8), colmap (<< 3.9)")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "snakemake (>= 7.21), slurm-client")
include(CPack)
