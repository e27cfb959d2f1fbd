# One OBJECT library per instruction set: the only objects that are compiled with its flags.
#
#   kiwami_add_isa(<isa> SOURCES <file>... [FEATURES <flag>...])
#
# The flags name features, and src/dispatch/cpu_features.cpp tests exactly those. Link-time
# optimisation is off, or the linker could move ISA code into baseline functions.

include(CheckCXXCompilerFlag)

set(KIWAMI_SSE_FEATURES -msse4.1)
set(KIWAMI_AVX2_FEATURES -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt -mf16c)
set(KIWAMI_AVX512_FEATURES ${KIWAMI_AVX2_FEATURES} -mavx512f -mavx512cd -mavx512bw -mavx512dq
                           -mavx512vl)

# What each instruction set has its own kernels for, and the files of kernels: one a width, in
# src/<isa>/<file>_w<width>.cpp.
set(KIWAMI_SCALAR_WIDTHS 4 8 16)
set(KIWAMI_SSE_WIDTHS 4)
set(KIWAMI_AVX2_WIDTHS 4 8)
set(KIWAMI_AVX512_WIDTHS 8 16)
set(KIWAMI_KERNEL_FILES kernels compact general multi_hit)

# Sets `result` to the sources of an instruction set.
function(kiwami_isa_sources isa result)
  string(TOUPPER ${isa} upper)
  set(sources ${PROJECT_SOURCE_DIR}/src/${isa}/kernel_table.cpp
              ${PROJECT_SOURCE_DIR}/src/${isa}/light_kernels.cpp)
  foreach(file IN LISTS KIWAMI_KERNEL_FILES)
    foreach(width IN LISTS KIWAMI_${upper}_WIDTHS)
      list(APPEND sources ${PROJECT_SOURCE_DIR}/src/${isa}/${file}_w${width}.cpp)
    endforeach()
  endforeach()
  set(${result} ${sources} PARENT_SCOPE)
endfunction()

function(kiwami_add_isa isa)
  cmake_parse_arguments(ARG "" "" "SOURCES;FEATURES" ${ARGN})
  set(target kiwami_isa_${isa})
  add_library(${target} OBJECT ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE kiwami_internal)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/${isa})
  target_compile_definitions(${target} PRIVATE KIWAMI_ISA=${isa})
  target_compile_options(${target} PRIVATE ${ARG_FEATURES} -fno-lto -fno-exceptions -fno-rtti
                                           -fno-math-errno -fno-asynchronous-unwind-tables)
  if(isa STREQUAL "scalar" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Vectors are plain arrays here: -O3 unrolls each of them, at three times the time of compiling.
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
  endif()
  if(KIWAMI_SANITIZE)
    # Forced inlining makes functions of which every access is checked and every variable tracked:
    # in full, they would take longer to compile than all of the rest.
    target_compile_options(${target} PRIVATE -O1 -g1)
  endif()
  if(isa STREQUAL "avx512" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC's own header reads an undefined register on purpose and warns of it (GCC bug 105593).
    target_compile_options(${target} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()
