# coppice_compile_shaders(TARGET shader.comp ...): compiles each to SPIR-V and embeds it, so that a program needs
# no files beside it. In C++: #include "shaders/NAME.comp.h" gives `inline constexpr uint32_t k_NAME_spirv[]`.
include_guard()
find_program(COPPICE_GLSLC glslc REQUIRED)

function(coppice_compile_shaders target)
  set(out_dir ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${out_dir})
  foreach(shader IN LISTS ARGN)
    get_filename_component(name ${shader} NAME)
    get_filename_component(stem ${shader} NAME_WE)
    set(words ${out_dir}/${name}.inc)
    set(header ${out_dir}/${name}.h)
    file(WRITE ${header}.in "#pragma once\n#include <cstdint>\ninline constexpr uint32_t k_${stem}_spirv[] =\n#include \"${name}.inc\"\n;\n")
    configure_file(${header}.in ${header} COPYONLY)
    add_custom_command(
      OUTPUT ${words}
      COMMAND ${COPPICE_GLSLC} --target-env=vulkan1.3 -O -Werror -mfmt=c -MD -MF ${words}.d
              -I ${PROJECT_SOURCE_DIR} -I ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${shader} -o ${words}
      DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${shader}
      DEPFILE ${words}.d
      COMMENT "Compiling shader ${name}" VERBATIM)
    target_sources(${target} PRIVATE ${words})
    set_source_files_properties(${words} PROPERTIES HEADER_FILE_ONLY ON GENERATED ON)
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
