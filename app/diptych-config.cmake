# find_package(diptych): the targets diptych::vk, diptych::gl, diptych::scene and diptych::play, static libraries diptych::vk_static,
# diptych::gl_static and diptych::scene_static, and diptych_generate(). Finds what belongs to it from where it lies, so the installed
# tree can be moved.
get_filename_component(DIPTYCH_LIBRARIES "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
get_filename_component(DIPTYCH_PREFIX "${DIPTYCH_LIBRARIES}/.." ABSOLUTE)
if(NOT EXISTS "${DIPTYCH_PREFIX}/bin/diptych-gen") # lib/TRIPLET
  get_filename_component(DIPTYCH_PREFIX "${DIPTYCH_PREFIX}/.." ABSOLUTE)
endif()
set(DIPTYCH_GENERATOR "${DIPTYCH_PREFIX}/bin/diptych-gen")
foreach(name IN ITEMS vk gl scene play)
  if(NOT TARGET diptych::${name})
    add_library(diptych::${name} SHARED IMPORTED)
    set_target_properties(diptych::${name} PROPERTIES
      IMPORTED_LOCATION "${DIPTYCH_LIBRARIES}/libdiptych_${name}.so"
      INTERFACE_INCLUDE_DIRECTORIES "${DIPTYCH_PREFIX}/include/diptych")
  endif()
  if(NOT TARGET diptych::${name}_static AND NOT name STREQUAL play)
    add_library(diptych::${name}_static STATIC IMPORTED)
    set_target_properties(diptych::${name}_static PROPERTIES
      IMPORTED_LOCATION "${DIPTYCH_LIBRARIES}/libdiptych_${name}.a"
      INTERFACE_INCLUDE_DIRECTORIES "${DIPTYCH_PREFIX}/include/diptych")
  endif()
endforeach()
set_target_properties(diptych::scene_static PROPERTIES
  INTERFACE_LINK_LIBRARIES "png;assimp;fyaml;dl;m"
  INTERFACE_LINK_OPTIONS "-Wl,-rpath,${DIPTYCH_PREFIX}/lib/diptych")

# diptych_generate(TARGET SPEC... [PUBLIC] [STATIC] [BACKENDS gl vk] [SET PATH=VALUE...])
#
# Adds the C code of each spec to the target, which then includes its header by #include "PIPELINE.h" and links the libraries
# of the backends (default: vk). PUBLIC: so do those that link the target. STATIC: the static libraries. SET overrides values of all
# specs. Each target has files of its own in the build folder, made anew when the spec, a body, or what these include has changed.
# With Ninja, files that come out the same are not compiled again.
function(diptych_generate target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "PUBLIC;STATIC" "" "BACKENDS;SET")
  set(scope PRIVATE)
  if(arg_PUBLIC)
    set(scope PUBLIC)
  endif()
  set(kind "")
  if(arg_STATIC)
    set(kind _static)
  endif()
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
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/diptych/${target}/${name}")
    set(files "${folder}/${name}.h" "${folder}/${name}.c")
    foreach(backend IN LISTS arg_BACKENDS)
      list(APPEND files "${folder}/${name}_${backend}_shaders.c")
      target_link_libraries(${target} ${scope} diptych::${backend}${kind})
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
    target_include_directories(${target} ${scope} "${folder}")
  endforeach()
endfunction()
