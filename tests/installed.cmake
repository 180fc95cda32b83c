# Installs a build into a folder, moves that, and there runs the command and builds and runs a program that uses the library.
#   cmake -DBUILD=build -DFLAGS=... -P tests/installed.cmake
cmake_minimum_required(VERSION 3.25)
set(folder ${BUILD}/tests/installed)
set(prefix ${folder}/moved)
set(example ${CMAKE_CURRENT_LIST_DIR}/library)

function(carry_out)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "${ARGN}\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${folder})
carry_out(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/first)
file(RENAME ${folder}/first ${prefix})
carry_out(${prefix}/bin/taut run pair --steps 10)
foreach(made share/man/man1/taut.1 share/bash-completion/completions/taut share/zsh/site-functions/_taut)
  file(SIZE ${prefix}/${made} size)  # fails where it is not there
  if(size LESS 2000)
    message(FATAL_ERROR "${made}: ${size} bytes")
  endif()
endforeach()
carry_out(${CMAKE_COMMAND} -S ${example} -B ${folder}/example -G Ninja -DCMAKE_PREFIX_PATH=${prefix}
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
carry_out(${CMAKE_COMMAND} --build ${folder}/example)
carry_out(${folder}/example/hanging_on ${prefix}/share/taut/scenes/double_pendulum.toml)
foreach(line "penalty +[0-9.]+e-0" "newton +[0-9.]+e-1")
  if(NOT said MATCHES "${line}")
    message(FATAL_ERROR "expected '${line}' in what it said:\n${said}")
  endif()
endforeach()
