# SPDX-License-Identifier: Apache-2.0
# Installs the build into a folder, moves that folder, and builds and runs consumers of it by
# find_package and pkg-config, and of the sources by add_subdirectory; shared and static, C and C++.
cmake_minimum_required(VERSION 3.22)

# Runs a command; its output is shown only when it fails.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${ARGN}\n${output}")
  endif()
  set(run_output "${output}" PARENT_SCOPE)
endfunction()

# Runs a consumer, which prints one line when its ray hits as it must.
function(run_consumer what)
  run("${what}" ${ARGN})
  if(NOT run_output STREQUAL "hit at 2\n")
    message(FATAL_ERROR "${what} printed '${run_output}', expected 'hit at 2'")
  endif()
  message(STATUS "${what}: works")
endfunction()

function(build_consumer mode library)
  set(folder ${WORK_DIR}/${mode}-${library})
  run("configuring ${mode} ${library}"
      ${CMAKE_COMMAND} -G ${GENERATOR} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${folder}
      -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
      -DCMAKE_C_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
      -DCMAKE_BUILD_TYPE=${CONFIG} -DCONSUMER_MODE=${mode} -DCONSUMER_LIBRARY=${library}
      -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DKIWAMI_SOURCE_DIR=${SOURCE_DIR}
      -DKIWAMI_TASKING=${TASKING} -DKIWAMI_ISAS=none)
  run("building ${mode} ${library}" ${CMAKE_COMMAND} --build ${folder} --parallel 2)
  foreach(language IN ITEMS c cpp hpp)
    run_consumer("${mode} ${library} ${language}" ${folder}/consumer_${language})
  endforeach()
endfunction()

# Compiles with the flags that pkg-config gives, without CMake.
function(build_with_pkg_config library)
  set(ENV{PKG_CONFIG_PATH} ${WORK_DIR}/prefix/${LIBDIR}/pkgconfig)
  set(options --cflags --libs)
  if(library STREQUAL "kiwami_static")
    list(APPEND options --static)
  endif()
  run("pkg-config" ${PKG_CONFIG} ${options} kiwami)
  string(STRIP "${run_output}" flags)
  if(library STREQUAL "kiwami_static")
    # Where both libraries stand, the linker takes the shared one unless it is told the file.
    string(REPLACE "-lkiwami" "-l:libkiwami.a" flags "${flags}")
  endif()
  separate_arguments(flags UNIX_COMMAND "${flags}")
  foreach(language IN ITEMS c cpp)
    set(compiler ${C_COMPILER} -std=c99)
    if(language STREQUAL "cpp")
      set(compiler ${CXX_COMPILER} -std=c++11)
    endif()
    set(program ${WORK_DIR}/pkg-config-${library}-${language})
    run("compiling by pkg-config ${library} ${language}"
        ${compiler} ${CMAKE_CURRENT_LIST_DIR}/consumer/consumer.${language} -o ${program} ${flags})
    run_consumer("pkg-config ${library} ${language}" ${CMAKE_COMMAND} -E env
                 LD_LIBRARY_PATH=${WORK_DIR}/prefix/${LIBDIR} ${program})
  endforeach()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run("installing" ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/staging)
file(RENAME ${WORK_DIR}/staging ${WORK_DIR}/prefix)

file(GLOB headers RELATIVE ${SOURCE_DIR}/include ${SOURCE_DIR}/include/kiwami/*.h)
foreach(header IN LISTS headers)
  if(NOT EXISTS ${WORK_DIR}/prefix/include/${header})
    message(FATAL_ERROR "${header} was not installed")
  endif()
endforeach()
file(GLOB_RECURSE licence ${WORK_DIR}/prefix/LICENSE)
if(NOT licence)
  message(FATAL_ERROR "LICENSE was not installed")
endif()

foreach(library IN LISTS LIBRARIES)
  build_consumer(find_package ${library})
  if(PKG_CONFIG)
    build_with_pkg_config(${library})
  else()
    message(STATUS "pkg-config ${library}: SKIPPED, there is no pkg-config")
  endif()
endforeach()
build_consumer(add_subdirectory kiwami)
build_consumer(add_subdirectory kiwami_static)
