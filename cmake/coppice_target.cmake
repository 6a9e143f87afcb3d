# What every target of the project shares. Nothing here leaks to consumers: all options are PRIVATE.
include_guard()
include(GNUInstallDirs)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(COPPICE_OUTPUT_DIR "${PROJECT_BINARY_DIR}")

# Same results from every compiler: no fused multiply-add, no relaxed mathematics. Nobody asks errno or the processor's
# flags about mathematics, so that loops may be made vectors of.
function(coppice_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  # The runtime's shared libraries export all they declare; programs and plugins (one C entry) export nothing else.
  get_target_property(type ${target} TYPE)
  set(hidden -fvisibility=hidden)
  if(type STREQUAL "SHARED_LIBRARY")
    set(hidden -fno-semantic-interposition)
  endif()
  # Names of vectors' parts that nobody uses cost time to compile; functions of Vulkan come from volk alone. Both concern
  # only sources of ours: a host's own are its own.
  target_compile_definitions(${target} PRIVATE GLM_FORCE_XYZW_ONLY VK_NO_PROTOTYPES)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wno-missing-field-initializers -ffp-contract=off
                                           -fno-math-errno -fno-trapping-math ${hidden} $<$<BOOL:${COPPICE_WERROR}>:-Werror>
                                           $<$<CONFIG:Release>:-O3>)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/coppice>)
  if(COPPICE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${COPPICE_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=undefined)
    target_link_options(${target} PUBLIC -fsanitize=${COPPICE_SANITIZE})
  endif()
  if(type STREQUAL "EXECUTABLE" AND COPPICE_SANITIZE MATCHES "address")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/sanitized_program.cpp)
  endif()
  if(type STREQUAL "EXECUTABLE")
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${COPPICE_OUTPUT_DIR}/bin
                                               INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  elseif(type STREQUAL "SHARED_LIBRARY")
    set_target_properties(${target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${COPPICE_OUTPUT_DIR}/lib
                                               INSTALL_RPATH "$ORIGIN" VERSION ${PROJECT_VERSION}
                                               SOVERSION ${PROJECT_VERSION_MAJOR})
  elseif(type STREQUAL "MODULE_LIBRARY")
    set_target_properties(${target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${COPPICE_OUTPUT_DIR}/lib/coppice
                                               PREFIX "" INSTALL_RPATH "$ORIGIN/..")
  endif()
endfunction()
