# canonpose_module(NAME SOURCES ... [TORCH_SOURCES ...] [LINKS ...] [PRIVATE_LINKS ...] [TESTS ...] [TORCH_TESTS ...] [TEST_LINKS ...])
#
# A folder of src/canonpose as a static library canonpose_NAME, with its tests as NAME_test. LINKS names modules above it
# in the layout and third-party targets that its headers need; PRIVATE_LINKS those that only its sources need. TORCH_SOURCES and
# TORCH_TESTS are those that include LibTorch's headers, which take 20 s to compile: they share a precompiled header, and in builds
# with CMAKE_UNITY_BUILD (preset release) few compiler calls.

include(TestUnits)

add_library(canonpose_options INTERFACE)
target_link_libraries(canonpose_options INTERFACE canonpose_openblas)
target_include_directories(canonpose_options INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(canonpose_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                                                   $<$<BOOL:${CANONPOSE_WERROR}>:-Werror>)
# GCC 12 sees overlapping copies in std::string's own code (its bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(canonpose_options INTERFACE -Wno-restrict)
endif()
if(CANONPOSE_SANITIZE)
  # A null pointer or another object is found by AddressSanitizer, too, and x86 reads from any address. These checks stand at every access, and take
  # a quarter of the time to compile and to run.
  target_compile_options(canonpose_options INTERFACE -fsanitize=address,undefined -fno-sanitize=null,object-size,alignment
                                                     -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  # Sanitizers make GCC warn of what is not so, most of all in precompiled system headers. The other builds have warnings as errors.
  target_compile_options(canonpose_options INTERFACE -w)
  target_link_options(canonpose_options INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(canonpose_options INTERFACE CANONPOSE_SANITIZED)  # for base/testing.h
  # Under AddressSanitizer, Eigen allocates otherwise than in Debian's libceres, and each frees what the other allocated.
  target_compile_definitions(canonpose_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
if(CANONPOSE_FUZZ)
  target_compile_options(canonpose_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# LibTorch's headers, compiled once for all that include them.
if(CANONPOSE_WITH_TORCH)
  file(WRITE ${PROJECT_BINARY_DIR}/torch_headers.cc "// Only its precompiled header is used.\n")
  add_library(canonpose_torch_headers OBJECT ${PROJECT_BINARY_DIR}/torch_headers.cc)
  target_link_libraries(canonpose_torch_headers PRIVATE canonpose_options canonpose_torch)
  target_precompile_headers(canonpose_torch_headers PRIVATE <torch/torch.h>)
endif()

# canonpose_torch_objects(NAME SOURCES ... LINKS ...): objects of sources that include LibTorch's headers.
function(canonpose_torch_objects name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${name} OBJECT ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE canonpose_options canonpose_torch ${ARG_LINKS})
  target_precompile_headers(${name} REUSE_FROM canonpose_torch_headers)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
endfunction()

# canonpose_share_headers(MODULE): what nearly all modules include is compiled once for all of them.
function(canonpose_share_headers module)
  if(NOT TARGET canonpose_headers)
    file(WRITE ${PROJECT_BINARY_DIR}/headers.cc "// Only its precompiled header is used.\n")
    add_library(canonpose_headers OBJECT ${PROJECT_BINARY_DIR}/headers.cc)
    target_link_libraries(canonpose_headers PRIVATE canonpose_options Eigen3::Eigen nlohmann_json::nlohmann_json fmt::fmt)
    target_precompile_headers(canonpose_headers PRIVATE <algorithm> <filesystem> <functional> <map> <optional> <string> <vector>
                              <Eigen/Geometry> <Eigen/LU> <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp>)
  endif()
  target_precompile_headers(${module} REUSE_FROM canonpose_headers)
  # Like -Wrestrict above: GCC 12 sees wrong sizes in std::string's own code, and shows it where that is precompiled.
  target_compile_options(${module} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
endfunction()

function(canonpose_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;TORCH_SOURCES;LINKS;PRIVATE_LINKS;TESTS;TORCH_TESTS;TEST_LINKS" ${ARGN})
  if(NOT CANONPOSE_WITH_TORCH)
    set(ARG_TORCH_SOURCES)
    set(ARG_TORCH_TESTS)
  endif()
  add_library(canonpose_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(canonpose_${name} PUBLIC ${ARG_LINKS} PRIVATE canonpose_options ${ARG_PRIVATE_LINKS})
  target_include_directories(canonpose_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT name MATCHES "^(base|skeleton)$")
    canonpose_share_headers(canonpose_${name})
  endif()
  if(ARG_TORCH_SOURCES)
    canonpose_torch_objects(canonpose_${name}_torch SOURCES ${ARG_TORCH_SOURCES} LINKS ${ARG_LINKS} ${ARG_PRIVATE_LINKS})
    target_sources(canonpose_${name} PRIVATE $<TARGET_OBJECTS:canonpose_${name}_torch>)
    target_link_libraries(canonpose_${name} PRIVATE canonpose_torch)
  endif()
  if(BUILD_TESTING AND (ARG_TESTS OR ARG_TORCH_TESTS))
    canonpose_test(${name}_test SOURCES ${ARG_TESTS} TORCH_SOURCES ${ARG_TORCH_TESTS}
                   LINKS canonpose_${name} ${ARG_PRIVATE_LINKS} ${ARG_TEST_LINKS})
  endif()
endfunction()

# canonpose_share_test_headers(TEST): GoogleTest and Eigen are compiled once for all tests. As an executable, because its flags must be theirs.
function(canonpose_share_test_headers test)
  if(NOT TARGET canonpose_test_headers)
    file(WRITE ${PROJECT_BINARY_DIR}/test_headers.cc "int main() {}\n")
    add_executable(canonpose_test_headers EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/test_headers.cc)
    target_link_libraries(canonpose_test_headers PRIVATE canonpose_options GTest::gmock Eigen3::Eigen)
    target_compile_options(canonpose_test_headers PRIVATE $<$<CONFIG:Release>:-O1>)
    target_precompile_headers(canonpose_test_headers PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Geometry> <filesystem> <vector>)
  endif()
  target_precompile_headers(${test} REUSE_FROM canonpose_test_headers)
endfunction()

# canonpose_test(NAME SOURCES ... [TORCH_SOURCES ...] LINKS ...): one GoogleTest program. CANONPOSE_TESTDATA is the
# project's own small inputs; CANONPOSE_SHARED the data beside the checkout, which may be absent.
function(canonpose_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;TORCH_SOURCES;LINKS" ${ARGN})
  if(CMAKE_UNITY_BUILD)
    canonpose_test_units(ARG_SOURCES ${name} ${ARG_SOURCES})
    canonpose_test_units(ARG_TORCH_SOURCES ${name}_torch ${ARG_TORCH_SOURCES})
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE canonpose_options ${ARG_LINKS} GTest::gmock_main)
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  if(CMAKE_UNITY_BUILD)
    canonpose_share_test_headers(${name})
  endif()
  set(targets ${name})
  if(ARG_TORCH_SOURCES)
    canonpose_torch_objects(${name}_torch SOURCES ${ARG_TORCH_SOURCES} LINKS ${ARG_LINKS} GTest::gmock)
    set_target_properties(${name}_torch PROPERTIES UNITY_BUILD OFF)
    target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_torch>)
    target_link_libraries(${name} PRIVATE canonpose_torch)
    list(APPEND targets ${name}_torch)
  endif()
  foreach(target ${targets})
    # Tests take longer to compile than to run.
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    target_compile_definitions(${target} PRIVATE CANONPOSE_TESTDATA="${PROJECT_SOURCE_DIR}/testdata"
                                                 CANONPOSE_SHARED="${PROJECT_SOURCE_DIR}/../shared")
  endforeach()
  set_property(GLOBAL APPEND PROPERTY CANONPOSE_PROGRAMS $<TARGET_FILE:${name}>)
  # The longest start first, and those that take longer than the others together run in parts, so that no processor waits at the end.
  set(seconds 10)
  set(parts 1)
  if(name STREQUAL "cli_test")
    set(seconds 100)
    set(parts 3)
  elseif(name STREQUAL "solve_test")
    set(seconds 100)
    set(parts 3)
  elseif(name STREQUAL "train_test")
    set(seconds 40)
  endif()
  foreach(part RANGE 1 ${parts})
    set(test ${name})
    if(parts GREATER 1)
      set(test ${name}_part${part})
    endif()
    math(EXPR index "${part} - 1")
    add_test(NAME ${test} COMMAND ${name})
    set_tests_properties(${test} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=${parts};GTEST_SHARD_INDEX=${index}"
                                            TIMEOUT $<IF:$<BOOL:${CANONPOSE_SANITIZE}>,3600,900> COST ${seconds})
  endforeach()
endfunction()
