# SPDX-License-Identifier: Apache-2.0
# The page of `kiwami inspect --html`, bundled from tools/inspect_page into the command.
#
# KIWAMI_INSPECT_PAGE   auto: where Node.js and npm are there and npm gets the packages; on: an error
#                       where they are not; off: the command is built without the page

set(KIWAMI_INSPECT_PAGE "auto" CACHE STRING "Bundle the page of `kiwami inspect`: auto, on or off")
set_property(CACHE KIWAMI_INSPECT_PAGE PROPERTY STRINGS auto on off)
include(KiwamiNpm)

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
