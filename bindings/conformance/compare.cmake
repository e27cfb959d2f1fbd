# SPDX-License-Identifier: Apache-2.0
# Writes the vectors anew and compares them with the committed ones.
execute_process(COMMAND ${MAKE_VECTORS} ${FEATURE} OUTPUT_FILE ${WORK} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "make_vectors failed: ${result}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${WORK} ${VECTORS} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${VECTORS} differs from what make_vectors writes to ${WORK}")
endif()
