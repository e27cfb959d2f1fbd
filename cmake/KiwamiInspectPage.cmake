# SPDX-License-Identifier: Apache-2.0
# The page of `kiwami inspect --html`, bundled from tools/inspect_page into the command.
#
# KIWAMI_INSPECT_PAGE   auto: where Node.js and npm are there and npm gets the packages; on: an error
#                       where they are not; off: the command is built without the page

set(KIWAMI_INSPECT_PAGE "auto" CACHE STRING "Bundle the page of `kiwami inspect`: auto, on or off")
set_property(CACHE KIWAMI_INSPECT_PAGE PROPERTY STRINGS auto on off)

# kiwami_install_npm_packages(FOLDER MODULES REASON): what FOLDER/package-lock.json names goes into
# the build tree, unless it is there. MODULES receives its node_modules; or "", and REASON the why.
function(kiwami_install_npm_packages folder modules reason)
  set(${modules} "" PARENT_SCOPE)
  find_program(KIWAMI_NODE NAMES node nodejs)
  find_program(KIWAMI_NPM npm)
  if(NOT KIWAMI_NODE OR NOT KIWAMI_NPM)
    set(${reason} "Node.js or npm is absent" PARENT_SCOPE)
    return()
  endif()
  execute_process(COMMAND "${KIWAMI_NODE}" --version OUTPUT_VARIABLE version
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT version MATCHES "^v([0-9]+)" OR CMAKE_MATCH_1 LESS 18)
    set(${reason} "Node.js is '${version}', expected 18 or newer" PARENT_SCOPE)
    return()
  endif()
  get_filename_component(name "${folder}" NAME)
  set(copy "${PROJECT_BINARY_DIR}/npm/${name}")
  set(stamp "${copy}/installed")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${folder}/package-lock.json")
  file(SHA256 "${folder}/package-lock.json" wanted)
  set(installed "")
  if(EXISTS "${stamp}")
    file(READ "${stamp}" installed)
  endif()
  if(NOT installed STREQUAL wanted)
    message(STATUS "Installing the npm packages of ${name}")
    file(REMOVE "${stamp}")
    file(COPY "${folder}/package.json" "${folder}/package-lock.json" "${folder}/.npmrc"
         DESTINATION "${copy}")
    execute_process(
      COMMAND "${KIWAMI_NPM}" ci --no-audit --no-fund --no-update-notifier --fetch-retries=1
      WORKING_DIRECTORY "${copy}" TIMEOUT 180
      RESULT_VARIABLE result OUTPUT_FILE "${copy}/npm.log" ERROR_FILE "${copy}/npm.log")
    if(NOT result EQUAL 0)
      set(${reason} "npm cannot get the packages of ${name}, see ${copy}/npm.log" PARENT_SCOPE)
      return()
    endif()
    file(WRITE "${stamp}" "${wanted}")
  endif()
  set(${modules} "${copy}/node_modules" PARENT_SCOPE)
endfunction()

# kiwami_add_inspect_page(TARGET): links the page, or its absence, into the command.
function(kiwami_add_inspect_page target)
  set(modules "")
  set(reason "KIWAMI_INSPECT_PAGE is off")
  set(folder "${PROJECT_SOURCE_DIR}/tools/inspect_page")
  if(NOT KIWAMI_INSPECT_PAGE STREQUAL "off")
    kiwami_install_npm_packages("${folder}" modules reason)
  endif()
  set_property(TARGET ${target} PROPERTY KIWAMI_PAGE_MISSING_BECAUSE "")
  if(NOT modules)
    if(KIWAMI_INSPECT_PAGE STREQUAL "on")
      message(FATAL_ERROR "KIWAMI_INSPECT_PAGE is on, but ${reason}")
    endif()
    message(STATUS "`kiwami inspect` does without its page: ${reason}")
    set_property(TARGET ${target} PROPERTY KIWAMI_PAGE_MISSING_BECAUSE "${reason}")
    target_sources(${target} PRIVATE inspect_page_absent.cpp)
    return()
  endif()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/generated/kiwami/inspect_page.cpp")
  file(GLOB scripts CONFIGURE_DEPENDS "${folder}/src/*.js")
  add_custom_command(
    OUTPUT "${source}"
    COMMAND "${KIWAMI_NODE}" "${folder}/build.mjs" "${modules}" "${source}"
    DEPENDS ${scripts} "${folder}/build.mjs" "${folder}/index.html" "${folder}/style.css"
            "${folder}/package-lock.json"
    COMMENT "Bundling the page of `kiwami inspect`" VERBATIM)
  target_sources(${target} PRIVATE "${source}")
endfunction()
