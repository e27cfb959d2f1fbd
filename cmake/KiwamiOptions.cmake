# What every target of the project is compiled with.
#
# kiwami_options   warnings, sanitizers, and the floating-point rules that the bit-identical results
#                  rest on: no contraction anywhere, since bounds and transforms are baseline code.

add_library(kiwami_options INTERFACE)
target_compile_options(kiwami_options INTERFACE -ffp-contract=off -Wall -Wextra -Wshadow
                                                -Wpointer-arith -Wcast-qual)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 sees overlapping copies inside std::string's own concatenation (GCC bug 105651).
  target_compile_options(kiwami_options INTERFACE -Wno-restrict)
endif()
if(KIWAMI_WARNINGS_AS_ERRORS)
  target_compile_options(kiwami_options INTERFACE -Werror)
endif()
if(KIWAMI_FUZZ)
  target_compile_options(kiwami_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(KIWAMI_SANITIZE)
  target_compile_options(kiwami_options INTERFACE -fsanitize=${KIWAMI_SANITIZE}
                                                  -fno-omit-frame-pointer
                                                  -fno-sanitize-recover=all)
  target_link_options(kiwami_options INTERFACE -fsanitize=${KIWAMI_SANITIZE})
endif()
