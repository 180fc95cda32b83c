# All parts of the plug-in that pip installs are built by what pip asks for, and CUDA's headers are taken where they are
# whole. An OpenMM of empty files is enough: nothing is compiled.
#   cmake -DBUILD=build -DPYTHON=/usr/bin/python3 -P tests/plugin_parts.cmake
cmake_minimum_required(VERSION 3.25)
set(folder ${BUILD}/tests/plugin_parts)
file(REMOVE_RECURSE ${folder})
foreach(file include/openmm/serialization/XmlSerializer.h include/lepton/CustomFunction.h lib/libOpenMM.so
    lib/plugins/libOpenMMCUDA.so lib/plugins/libOpenMMHIP.so)
  file(WRITE ${folder}/OpenMM.libs/${file} "")
endforeach()
file(WRITE ${folder}/hip/hip/hip_runtime.h "")
file(WRITE ${folder}/cuda/include/cuda.h "")

function(configure)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env CUDA_HOME=${folder}/cuda ${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/..
      -B ${folder}/build -DTAUT_ENGINE=${BUILD} -DTAUT_WITH_PYTHON=ON -DPython_EXECUTABLE=${PYTHON} -DTAUT_OPENMM_VERSION=8.6
      -DTAUT_OPENMM_ROOT=${folder}/OpenMM.libs -DTAUT_HIP_INCLUDE=${folder}/hip
    RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "${said}")
  endif()
  execute_process(COMMAND ninja -C ${folder}/build -t commands python_package OUTPUT_VARIABLE built COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${folder}/build/openmm_plugin/cmake_install.cmake installed)
  foreach(part ${ARGN})
    foreach(list built installed)
      if(NOT "${${list}}" MATCHES "libtaut_openmm${part}\\.so")
        message(FATAL_ERROR "libtaut_openmm${part}.so is not ${list}")
      endif()
    endforeach()
  endforeach()
endfunction()

configure("" _hip)
load_cache(${folder}/build READ_WITH_PREFIX of_ TAUT_CUDA_INCLUDE)
if(of_TAUT_CUDA_INCLUDE STREQUAL "${folder}/cuda/include")
  message(FATAL_ERROR "a cuda.h without crt/ was taken for CUDA's headers")
endif()
file(WRITE ${folder}/cuda/include/crt/host_defines.h "")
configure("" _cuda _hip)
