# The Python module (python/): sets LEFORT_BUILD_PYTHON. Include it before the layers: their objects become
# part of a shared library and must then be position-independent.

# Debian's interpreter, for which the modules in dist-packages are; not another one that is first on PATH.
set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Interpreter for which the module lefort is built")
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 CONFIG QUIET)

# Python itself is not built with the sanitizers or for the fuzzer.
set(default OFF)
if(pybind11_FOUND AND Python_Development.Module_FOUND AND NOT LEFORT_SANITIZE AND NOT LEFORT_FUZZ)
  set(default ON)
endif()
option(LEFORT_BUILD_PYTHON "Build the Python module lefort" ${default})
if(LEFORT_BUILD_PYTHON)
  if(NOT pybind11_FOUND OR NOT Python_Development.Module_FOUND)
    message(FATAL_ERROR "LEFORT_BUILD_PYTHON needs Debian's pybind11-dev and python3-dev (script/install)")
  endif()
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
