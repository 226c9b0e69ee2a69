# Every library the project uses; all are Debian 12 packages (scripts/setup.sh installs them).

# All linear algebra is OpenBLAS's, whatever else is installed: Debian's libceres-dev brings ATLAS, which multiplies matrices
# several times slower and would answer LibTorch's calls, too, if it came first in the program's list of libraries.
set(BLA_VENDOR OpenBLAS)
find_package(BLAS)
find_package(LAPACK)
if(NOT BLAS_FOUND OR NOT LAPACK_FOUND)
  message(FATAL_ERROR "OpenBLAS is needed and was not found: apt-get install libopenblas-pthread-dev")
endif()
list(GET BLAS_LIBRARIES 0 CANONPOSE_OPENBLAS)
file(REAL_PATH ${CANONPOSE_OPENBLAS} CANONPOSE_OPENBLAS_FILE)
if(NOT CANONPOSE_OPENBLAS_FILE MATCHES "openblas")
  message(FATAL_ERROR "${CANONPOSE_OPENBLAS} is ${CANONPOSE_OPENBLAS_FILE}, not OpenBLAS: apt-get install libopenblas-pthread-dev")
endif()
# A program takes a routine from the first library in its list that has it, and so do the libraries that it loads.
add_library(canonpose_openblas INTERFACE)
target_link_options(canonpose_openblas INTERFACE "SHELL:-Wl,--push-state,--no-as-needed ${CANONPOSE_OPENBLAS} -Wl,--pop-state")

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED COMPONENTS SuiteSparse)
get_target_property(ceres_libraries Ceres::ceres INTERFACE_LINK_LIBRARIES)
list(FILTER ceres_libraries EXCLUDE REGEX "/lib(lapack|blas|f77blas|atlas)\\.(so|a)$")
set_property(TARGET Ceres::ceres PROPERTY INTERFACE_LINK_LIBRARIES ${ceres_libraries} ${BLAS_LIBRARIES})
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(PkgConfig REQUIRED)
find_package(ZLIB REQUIRED)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
pkg_check_modules(TINYGLTF REQUIRED IMPORTED_TARGET tinygltf)
pkg_check_modules(PUGIXML REQUIRED IMPORTED_TARGET pugixml)
pkg_check_modules(TOMLPLUSPLUS REQUIRED tomlplusplus)  # headers alone
pkg_check_modules(YAMLCPP REQUIRED IMPORTED_TARGET yaml-cpp)
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
endif()

if(CANONPOSE_WITH_TORCH)
  find_package(Torch REQUIRED)
  # TORCH_CXX_FLAGS is the ABI of the standard library that this LibTorch was built with: it must be that of the whole program.
  string(APPEND CMAKE_CXX_FLAGS " ${TORCH_CXX_FLAGS}")
  # LibTorch's headers are not ours to warn about.
  add_library(canonpose_torch INTERFACE)
  target_link_libraries(canonpose_torch INTERFACE ${TORCH_LIBRARIES})
  target_include_directories(canonpose_torch SYSTEM INTERFACE ${TORCH_INCLUDE_DIRS})

  # Four of OpenCV's modules. Its own CMake file and pkg-config's belong to a package with all of them and 60 others, which nothing here needs.
  find_path(CANONPOSE_OPENCV_INCLUDE opencv2/videoio.hpp PATH_SUFFIXES opencv4)
  if(NOT CANONPOSE_OPENCV_INCLUDE)
    message(FATAL_ERROR "OpenCV's videoio is needed and was not found: apt-get install libopencv-videoio-dev")
  endif()
  add_library(canonpose_opencv INTERFACE)
  target_include_directories(canonpose_opencv SYSTEM INTERFACE ${CANONPOSE_OPENCV_INCLUDE})
  foreach(module core imgproc imgcodecs videoio)
    find_library(CANONPOSE_OPENCV_${module} opencv_${module} REQUIRED)
    target_link_libraries(canonpose_opencv INTERFACE ${CANONPOSE_OPENCV_${module}})
  endforeach()
endif()

add_library(canonpose_hdf5 INTERFACE)
target_include_directories(canonpose_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
target_link_libraries(canonpose_hdf5 INTERFACE ${HDF5_LIBRARIES})
target_compile_definitions(canonpose_hdf5 INTERFACE ${HDF5_DEFINITIONS})
