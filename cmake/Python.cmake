# CANONPOSE_WITH_PYTHON, the Python module (python/): on where the headers of Python and pybind11, and NumPy are found.
# Python is Debian's, whose packages pybind11 and NumPy are, even if there is another in PATH; -DPython3_EXECUTABLE chooses.
find_program(Python3_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module NumPy)
find_package(pybind11 2.10 QUIET CONFIG)
if(Python3_FOUND AND pybind11_FOUND AND NOT CANONPOSE_SANITIZE)  # whose runtime Python would have to load first
  set(found ON)
else()
  set(found OFF)
endif()
option(CANONPOSE_WITH_PYTHON "Build the Python module" ${found})
if(CANONPOSE_WITH_PYTHON)
  if(NOT Python3_FOUND OR NOT pybind11_FOUND)
    message(FATAL_ERROR "The Python module needs the headers of Python and pybind11, and NumPy: apt-get install python3-dev pybind11-dev python3-numpy")
  endif()
  add_subdirectory(python)
endif()
