# find_package(diptych): the targets diptych::vk, diptych::gl, diptych::scene and diptych::play, and diptych_generate(). Finds what belongs to
# it from where it lies, so the installed tree can be moved.
get_filename_component(DIPTYCH_PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(DIPTYCH_GENERATOR "${DIPTYCH_PREFIX}/bin/diptych-gen")
foreach(name IN ITEMS vk gl scene play)
  if(NOT TARGET diptych::${name})
    add_library(diptych::${name} SHARED IMPORTED)
    set_target_properties(diptych::${name} PROPERTIES
      IMPORTED_LOCATION "${DIPTYCH_PREFIX}/lib/libdiptych_${name}.so"
      INTERFACE_INCLUDE_DIRECTORIES "${DIPTYCH_PREFIX}/include/diptych")
  endif()
endforeach()

# diptych_generate(TARGET SPEC... [BACKENDS gl vk] [SET PATH=VALUE...])
#
# Adds the C code of each spec to the target, which then includes its header by #include "PIPELINE.h" and links the libraries
# of the backends (default: vk). SET overrides values of all specs. The files are made in the build folder, anew when the spec,
# a body, or what these include has changed. With Ninja, files that come out the same are not compiled again.
function(diptych_generate target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "BACKENDS;SET")
  if(NOT arg_BACKENDS)
    set(arg_BACKENDS vk)
  endif()
  set(sets "")
  foreach(set IN LISTS arg_SET)
    list(APPEND sets --set "${set}")
  endforeach()
  foreach(spec IN LISTS arg_UNPARSED_ARGUMENTS)
    get_filename_component(spec "${spec}" ABSOLUTE)
    file(STRINGS "${spec}" name REGEX "^pipeline:" LIMIT_COUNT 1)
    if(NOT name MATCHES "^pipeline: *[\"']?([A-Za-z0-9_]+)")
      message(FATAL_ERROR "diptych_generate: ${spec} has no line `pipeline: NAME`")
    endif()
    set(name "${CMAKE_MATCH_1}")
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/diptych/${name}")
    set(files "${folder}/${name}.h" "${folder}/${name}.c")
    foreach(backend IN LISTS arg_BACKENDS)
      list(APPEND files "${folder}/${name}_${backend}_shaders.c")
      target_link_libraries(${target} PRIVATE diptych::${backend})
    endforeach()
    set(touch "")
    if(NOT CMAKE_GENERATOR MATCHES "Ninja") # Make would generate again and again what came out the same
      set(touch COMMAND "${CMAKE_COMMAND}" -E touch ${files})
    endif()
    add_custom_command(
      OUTPUT ${files}
      COMMAND "${DIPTYCH_GENERATOR}" "${spec}" ${sets} -o "${folder}" --depfile "${folder}/${name}.d"
      ${touch}
      DEPENDS "${DIPTYCH_GENERATOR}" "${spec}"
      DEPFILE "${folder}/${name}.d"
      COMMENT "Generating ${name}"
      VERBATIM)
    target_sources(${target} PRIVATE ${files})
    target_include_directories(${target} PRIVATE "${folder}")
  endforeach()
endfunction()
