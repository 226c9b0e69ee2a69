# canonpose_module(NAME SOURCES ... [LINKS ...] [PRIVATE_LINKS ...] [TESTS ...] [TEST_LINKS ...] [PRECOMPILE ...])
#
# A folder of src/canonpose as a static library canonpose_NAME, with its tests as NAME_test. LINKS names modules above it
# in the layout and third-party targets that its headers need; PRIVATE_LINKS those that only its sources need. PRECOMPILE names
# headers that take long to compile (LibTorch's take 20 s).

add_library(canonpose_options INTERFACE)
target_include_directories(canonpose_options INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(canonpose_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                                                   $<$<BOOL:${CANONPOSE_WERROR}>:-Werror>)
# GCC 12 sees overlapping copies in std::string's own code (its bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(canonpose_options INTERFACE -Wno-restrict)
endif()
if(CANONPOSE_SANITIZE)
  target_compile_options(canonpose_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                     -fno-omit-frame-pointer)
  target_link_options(canonpose_options INTERFACE -fsanitize=address,undefined)
endif()

function(canonpose_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS;TESTS;TEST_LINKS;PRECOMPILE" ${ARGN})
  add_library(canonpose_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(canonpose_${name} PUBLIC ${ARG_LINKS} PRIVATE canonpose_options ${ARG_PRIVATE_LINKS})
  target_include_directories(canonpose_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  if(BUILD_TESTING AND ARG_TESTS)
    canonpose_test(${name}_test SOURCES ${ARG_TESTS} LINKS canonpose_${name} ${ARG_PRIVATE_LINKS} ${ARG_TEST_LINKS})
  endif()
  if(ARG_PRECOMPILE)
    target_precompile_headers(canonpose_${name} PRIVATE ${ARG_PRECOMPILE})
    if(TARGET ${name}_test)
      target_precompile_headers(${name}_test PRIVATE ${ARG_PRECOMPILE})
    endif()
  endif()
endfunction()

# canonpose_test(NAME SOURCES ... LINKS ...): one GoogleTest program, one ctest entry. CANONPOSE_TESTDATA is the project's own
# small inputs; CANONPOSE_SHARED the data beside the checkout, which may be absent.
function(canonpose_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE canonpose_options ${ARG_LINKS} GTest::gmock_main)
  target_compile_definitions(${name} PRIVATE CANONPOSE_TESTDATA="${PROJECT_SOURCE_DIR}/testdata"
                                             CANONPOSE_SHARED="${PROJECT_SOURCE_DIR}/../shared")
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT 900)
endfunction()
