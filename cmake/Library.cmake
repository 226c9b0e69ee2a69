# canonpose::canonpose, the installed library: all folders but cli in one shared library, so that a project that uses it
# needs Eigen's and fmt's headers and nothing else.

# The promise: headers that keep working. Those that they include are installed with them, but may change.
set(CANONPOSE_PUBLIC_HEADERS
  base/callbacks.h base/error.h base/version.h
  skeleton/skeleton.h
  geometry/camera.h
  scene/lifted_poses.h scene/pose_sequence.h scene/scene.h scene/world.h scene/world_measures.h
  data/choice.h data/dataset.h data/import.h data/read_scenes.h data/solved_scene.h data/readers/benchmarks/benchmark.h
  simulate/simulator.h
  evaluate/report.h
  solve/solver.h
  analyse/analysis.h analyse/filter.h
  export/calibration.h export/lift_output.h export/scene_formats.h
  view/page.h view/page_content.h view/skeleton_strip.h
  pipeline/bootstrap.h pipeline/evaluate_datasets.h)
if(CANONPOSE_WITH_TORCH)
  list(APPEND CANONPOSE_PUBLIC_HEADERS train/trainer.h lift/pose_lifter.h pipeline/lift_views.h pipeline/solve_then_train.h)
endif()

# canonpose_headers_included(HEADERS...): sets `headers` to them and all that they include of ours.
function(canonpose_headers_included)
  set(found)
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open header)
    if(header IN_LIST found)
      continue()
    endif()
    list(APPEND found ${header})
    file(STRINGS ${PROJECT_SOURCE_DIR}/src/canonpose/${header} includes REGEX "^#include \"canonpose/")
    foreach(line IN LISTS includes)
      string(REGEX REPLACE "^#include \"canonpose/(.*)\"$" "\\1" included ${line})
      list(APPEND open ${included})
    endforeach()
  endwhile()
  set(headers ${found} PARENT_SCOPE)
endfunction()

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

file(WRITE ${PROJECT_BINARY_DIR}/library.cc "// The library's parts are all there is in it.\n")
add_library(canonpose_library SHARED ${PROJECT_BINARY_DIR}/library.cc)
set_target_properties(canonpose_library PROPERTIES
  OUTPUT_NAME canonpose EXPORT_NAME canonpose VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
# All objects of the modules, and what the modules are linked with.
foreach(module IN LISTS CANONPOSE_MODULES)
  if(module STREQUAL "cli")
    continue()
  endif()
  target_sources(canonpose_library PRIVATE $<TARGET_OBJECTS:canonpose_${module}>)
  if(TARGET canonpose_${module}_torch)
    target_sources(canonpose_library PRIVATE $<TARGET_OBJECTS:canonpose_${module}_torch>)
  endif()
  target_link_libraries(canonpose_library PRIVATE canonpose_${module})
endforeach()
target_link_libraries(canonpose_library PRIVATE canonpose_options)
target_link_libraries(canonpose_library PUBLIC Eigen3::Eigen fmt::fmt)
target_compile_features(canonpose_library PUBLIC cxx_std_20)
target_include_directories(canonpose_library PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
add_library(canonpose::canonpose ALIAS canonpose_library)

install(TARGETS canonpose_library EXPORT canonposeTargets)
canonpose_headers_included(${CANONPOSE_PUBLIC_HEADERS})
foreach(header IN LISTS headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/src/canonpose/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/canonpose/${folder})
endforeach()
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/canonpose)
install(EXPORT canonposeTargets NAMESPACE canonpose:: DESTINATION ${package_folder})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/canonposeConfig.cmake.in ${PROJECT_BINARY_DIR}/canonposeConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/canonposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/canonposeConfig.cmake ${PROJECT_BINARY_DIR}/canonposeConfigVersion.cmake DESTINATION ${package_folder})

# `cmake --build build --target docs`: the public headers as web pages; warnings are errors.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  set(DOXYGEN_PROJECT_NAME canonpose)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  set(DOXYGEN_EXTRACT_ALL YES)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/src)
  set(DOXYGEN_FULL_PATH_NAMES YES)
  set(public ${CANONPOSE_PUBLIC_HEADERS})
  list(TRANSFORM public PREPEND ${PROJECT_SOURCE_DIR}/src/canonpose/)
  doxygen_add_docs(docs ${public} COMMENT "Documentation of the library in ${PROJECT_BINARY_DIR}/html")
endif()
