# What a host gets: libraries under names in coppice::, in this build and installed, the headers they need, the plugins,
# and files for CMake and pkg-config.
include_guard()
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# coppice_export(TARGET NAME): the library is coppice::NAME, here and where it is installed.
function(coppice_export target name)
  add_library(coppice::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT coppice
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

# coppice_install_plugin(TARGET): a module that Registry::load finds beside the installed libraries.
function(coppice_install_plugin target)
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/coppice)
endfunction()

# Once, after all targets.
function(coppice_install_package)
  set(include_dir ${CMAKE_INSTALL_INCLUDEDIR}/coppice)
  install(DIRECTORY runtime plugins DESTINATION ${include_dir} FILES_MATCHING PATTERN "*.h"
          PATTERN runtime/window EXCLUDE PATTERN plugins/vegetation/cook/import EXCLUDE)
  install(EXPORT coppice NAMESPACE coppice:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coppice
          FILE coppice-targets.cmake)
  configure_package_config_file(cmake/coppice-config.cmake.in cmake/coppice-config.cmake
                                INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coppice)
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/cmake/coppice-config-version.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cmake/coppice-config.cmake
                ${CMAKE_CURRENT_BINARY_DIR}/cmake/coppice-config-version.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coppice)
  # A prefix may be moved, and is only known when it is installed to.
  file(RELATIVE_PATH pkgconfig_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  foreach(package c runtime vegetation-core vegetation)
    configure_file(cmake/coppice-${package}.pc.in cmake/coppice-${package}.pc @ONLY)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cmake/coppice-${package}.pc
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  endforeach()
endfunction()
