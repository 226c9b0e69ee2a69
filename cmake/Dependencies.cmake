# Every library the project uses; all are Debian 12 packages (scripts/setup.sh installs them).
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED COMPONENTS SuiteSparse)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(PkgConfig REQUIRED)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
find_package(Torch REQUIRED)
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
endif()

# TORCH_CXX_FLAGS is the ABI of the standard library that this LibTorch was built with: it must be that of the whole program.
string(APPEND CMAKE_CXX_FLAGS " ${TORCH_CXX_FLAGS}")
# LibTorch's headers are not ours to warn about.
add_library(canonpose_torch INTERFACE)
target_link_libraries(canonpose_torch INTERFACE ${TORCH_LIBRARIES})
target_include_directories(canonpose_torch SYSTEM INTERFACE ${TORCH_INCLUDE_DIRS})

add_library(canonpose_hdf5 INTERFACE)
target_include_directories(canonpose_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
target_link_libraries(canonpose_hdf5 INTERFACE ${HDF5_LIBRARIES})
target_compile_definitions(canonpose_hdf5 INTERFACE ${HDF5_DEFINITIONS})
