# One interface target carries the compile options of every Brisance library.
add_library(brisance_flags INTERFACE)
target_include_directories(brisance_flags INTERFACE ${CMAKE_SOURCE_DIR}/src)
target_compile_options(brisance_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)

# Value-safe options that let loops with sqrt, comparisons and selections vectorise. Not -ffast-math: NaN checks,
# the order of sums and bit-identical results must survive.
target_compile_options(brisance_flags INTERFACE -fno-math-errno -fno-trapping-math -ffp-contract=fast)
if(BRISANCE_NATIVE)
  target_compile_options(brisance_flags INTERFACE -march=native)
endif()
# Kernels in several sets of vector instructions, of which a run takes the best that its processor has. Without
# optimisation they would share inline functions with files that must run on any processor.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  set(BRISANCE_SIMD_SETS ON)
  target_compile_definitions(brisance_flags INTERFACE BRISANCE_SIMD_SETS)
endif()
if(BRISANCE_SANITIZE)
  target_compile_options(brisance_flags INTERFACE -fsanitize=${BRISANCE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(brisance_flags INTERFACE -fsanitize=${BRISANCE_SANITIZE})
endif()

# brisance_library(NAME SOURCES ... LINKS ...): one layer of the program.
function(brisance_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(ARG_SOURCES)
    add_library(brisance_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(brisance_${name} PUBLIC brisance_flags ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  else()
    add_library(brisance_${name} INTERFACE)
    target_link_libraries(brisance_${name} INTERFACE brisance_flags ${ARG_LINKS})
  endif()
endfunction()
