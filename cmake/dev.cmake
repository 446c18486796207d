# What our own tests, examples and benchmarks are built with; users never see it.
add_library(surfleet_flags INTERFACE)
target_compile_options(surfleet_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion)
# What changes no result: no caller asks for `errno` after a root, nor for floating-point traps, and
# with them loops do not become vector code.
target_compile_options(surfleet_flags INTERFACE -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # As with g++, whose -Wconversion leaves signs alone.
  target_compile_options(surfleet_flags INTERFACE -Wno-sign-conversion)
endif()
if(SURFLEET_WERROR)
  target_compile_options(surfleet_flags INTERFACE -Werror)
endif()
if(SURFLEET_NATIVE)
  # Eigen's alignment stays the one the distribution's libraries were compiled with. AVX-512 is left
  # out: g++ 12 warns of its own intrinsics.
  target_compile_options(surfleet_flags INTERFACE -march=native -mno-avx512f)
  target_compile_definitions(surfleet_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
endif()
if(SURFLEET_SANITIZE)
  # What the address sanitizer stops at anyway costs a fifth of the compiler's time.
  target_compile_options(surfleet_flags INTERFACE -fsanitize=${SURFLEET_SANITIZE}
                         $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=null,alignment,object-size,vptr>
                         -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(surfleet_flags INTERFACE -fsanitize=${SURFLEET_SANITIZE})
endif()
target_include_directories(surfleet_flags INTERFACE ${PROJECT_SOURCE_DIR}/examples)
target_link_libraries(surfleet_flags INTERFACE surfleet)
foreach(component fcl embree png zstd)
  if(TARGET surfleet_${component})
    target_link_libraries(surfleet_flags INTERFACE surfleet_${component})
  endif()
endforeach()

target_link_libraries(surfleet_compiled PRIVATE surfleet_flags)
add_library(surfleet_dev INTERFACE)
target_link_libraries(surfleet_dev INTERFACE surfleet_flags surfleet_compiled)

# What every program includes, parsed once.
set(parsed_headers <Eigen/Dense> <algorithm> <functional> <map> <random> <span> <string> <unordered_map> <vector>)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/surfleet_parsed.cpp CONTENT "")
add_library(surfleet_parsed STATIC EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/surfleet_parsed.cpp)
target_link_libraries(surfleet_parsed PRIVATE surfleet_dev)
target_precompile_headers(surfleet_parsed PRIVATE ${parsed_headers})

# Packages that single files ask for with a line `// requires: name`.
find_package(octomap QUIET)
find_package(ompl QUIET)
find_package(CGAL QUIET)
find_package(zstd QUIET)
set(dds_FOUND ${CycloneDDS_FOUND})
# Its package of two modules brings no file for CMake.
find_path(OPENCV_INCLUDE opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
find_library(OPENCV_CALIB3D opencv_calib3d)
find_library(OPENCV_CORE opencv_core)
add_library(surfleet_opencv INTERFACE)
if(OPENCV_INCLUDE AND OPENCV_CALIB3D AND OPENCV_CORE)
  set(opencv_FOUND TRUE)
  target_include_directories(surfleet_opencv SYSTEM INTERFACE ${OPENCV_INCLUDE})
  target_link_libraries(surfleet_opencv INTERFACE ${OPENCV_CALIB3D} ${OPENCV_CORE})
endif()
add_library(surfleet_octomap INTERFACE)
target_link_libraries(surfleet_octomap INTERFACE ${OCTOMAP_LIBRARIES})
add_library(surfleet_ompl INTERFACE)
target_include_directories(surfleet_ompl SYSTEM INTERFACE ${OMPL_INCLUDE_DIRS})
target_link_libraries(surfleet_ompl INTERFACE ${OMPL_LIBRARIES})
add_library(surfleet_cgal INTERFACE)
if(TARGET CGAL::CGAL)
  target_link_libraries(surfleet_cgal INTERFACE CGAL::CGAL)
endif()

# surfleet_program(name source): an executable of ours, unless a package it requires is missing.
function(surfleet_program name source)
  file(STRINGS ${source} requirements REGEX "^// requires: " LIMIT_COUNT 4)
  foreach(line IN LISTS requirements)
    string(REGEX REPLACE "^// requires: " "" packages "${line}")
    string(REGEX MATCHALL "[a-z]+" packages "${packages}")
    foreach(package IN LISTS packages)
      if(NOT ${package}_FOUND AND NOT (package STREQUAL "cgal" AND TARGET CGAL::CGAL))
        message(STATUS "${name}: ${package} not found, left out")
        return()
      endif()
      list(APPEND libraries surfleet_${package})
    endforeach()
  endforeach()
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE surfleet_dev ${libraries})
  if(NOT libraries)  # other packages may bring options that the parsed headers do not have
    target_precompile_headers(${name} REUSE_FROM surfleet_parsed)
  endif()
endfunction()
