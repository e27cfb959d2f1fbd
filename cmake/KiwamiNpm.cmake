# SPDX-License-Identifier: Apache-2.0
# Packages from npm, which go into the build tree.

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
