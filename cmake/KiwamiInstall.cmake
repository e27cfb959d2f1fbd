# SPDX-License-Identifier: Apache-2.0
# Install rules: libraries, headers, the CMake package and the pkg-config file.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(kiwami_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kiwami)

# One export per library: who links the shared one needs no oneTBB to configure.
function(kiwami_install_library target export)
  install(TARGETS ${target} EXPORT ${export}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT ${export} NAMESPACE kiwami:: DESTINATION ${kiwami_cmake_dir})
endfunction()

if(KIWAMI_BUILD_SHARED)
  kiwami_install_library(kiwami kiwamiSharedTargets)
endif()
if(KIWAMI_BUILD_STATIC)
  kiwami_install_library(kiwami_static kiwamiStaticTargets)
endif()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kiwami DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/kiwami-config.cmake.in ${PROJECT_BINARY_DIR}/kiwami-config.cmake
  INSTALL_DESTINATION ${kiwami_cmake_dir} NO_SET_AND_CHECK_MACRO)
# Before version 1 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kiwami-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kiwami-config.cmake
              ${PROJECT_BINARY_DIR}/kiwami-config-version.cmake
        DESTINATION ${kiwami_cmake_dir})

# pkg-config: the prefix is relative to the file, so that the installed tree can be moved.
set(kiwami_pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH kiwami_pc_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
     ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH kiwami_pc_libdir ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH kiwami_pc_includedir ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(kiwami_pc_static_libs "-lstdc++ -lm -lpthread")
set(kiwami_pc_static_requires "")
if(KIWAMI_TASKING STREQUAL "tbb")
  set(kiwami_pc_static_requires "tbb")
endif()
set(kiwami_pc_libs "")
set(kiwami_pc_requires "")
if(NOT KIWAMI_BUILD_SHARED)
  set(kiwami_pc_libs " ${kiwami_pc_static_libs}")
  set(kiwami_pc_requires "${kiwami_pc_static_requires}")
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/kiwami.pc.in ${PROJECT_BINARY_DIR}/kiwami.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/kiwami.pc DESTINATION ${kiwami_pkgconfig_dir})
